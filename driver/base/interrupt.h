/** Polling for SIGINT, SIGTERM and SIGUSR1 (the warning of batch systems) during a run. Leaf module. */
#pragma once

#include <signal.h>

/** Number of the signal that requested the end of the program; 0 if none did. */
extern volatile sig_atomic_t interrupt_signal;

/** Install handlers that only record these signals. A file that exceeds the size limit becomes a write error, not a
 *  signal. */
void interrupt_install(void);
/** "SIGINT", "SIGTERM" or "SIGUSR1" */
const char *interrupt_name(int signal);

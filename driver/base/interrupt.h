/** SIGINT, SIGTERM and SIGUSR1, by which batch systems warn, as a question that a run asks now and then. A leaf. */
#pragma once

#include <signal.h>

/** Number of the signal that asked the program to end; 0 if none did. */
extern volatile sig_atomic_t interrupt_signal;

/** From now on these signals are only noted. A file that grows too large is an error of write, no signal. */
void interrupt_install(void);
/** "SIGINT", "SIGTERM" or "SIGUSR1" */
const char *interrupt_name(int signal);

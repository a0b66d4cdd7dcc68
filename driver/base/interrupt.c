#include "base/interrupt.h"

#include <stddef.h>

volatile sig_atomic_t interrupt_signal;

static void note(int signal)
{
    interrupt_signal = signal;
}

/** A shell that starts a job in the background sets SIGINT to be ignored; that setting is preserved. */
static void install(int signal)
{
    struct sigaction old;
    struct sigaction noting = {.sa_handler = note, .sa_flags = SA_RESTART};
    (void)sigemptyset(&noting.sa_mask);
    if (sigaction(signal, NULL, &old) == 0 && old.sa_handler != SIG_IGN) {
        (void)sigaction(signal, &noting, NULL);
    }
}

void interrupt_install(void)
{
    struct sigaction ignoring = {.sa_handler = SIG_IGN};
    (void)sigemptyset(&ignoring.sa_mask);
    (void)sigaction(SIGXFSZ, &ignoring, NULL);
    install(SIGINT);
    install(SIGTERM);
    install(SIGUSR1);
}

const char *interrupt_name(int signal)
{
    return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGUSR1";
}

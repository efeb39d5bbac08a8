#include "generator/run/stopping.h"

#include <stddef.h>

volatile sig_atomic_t stopping_signal;

static const int signals[STOPPING_SIGNALS] = {SIGINT, SIGTERM, SIGHUP};

static void on_signal(int signal_number) {
  if (!stopping_signal) stopping_signal = signal_number;
}

void stopping_catch(stopping *s) {
  stopping_signal = 0;
  for (int k = 0; k < STOPPING_SIGNALS; k++) {
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(signals[k], NULL, &s->before[k]);
    if (s->before[k].sa_handler != SIG_IGN) sigaction(signals[k], &action, NULL);
  }
}

void stopping_release(const stopping *s) {
  for (int k = 0; k < STOPPING_SIGNALS; k++)
    sigaction(signals[k], &s->before[k], NULL);
}

void stopping_hold(sigset_t *as_it_was) {
  sigset_t held;
  sigemptyset(&held);
  for (int k = 0; k < STOPPING_SIGNALS; k++)
    sigaddset(&held, signals[k]);
  sigprocmask(SIG_BLOCK, &held, as_it_was);
}

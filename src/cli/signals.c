#include "cli/signals.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* These are the only variables at file scope, because signal handlers have no other means of
 * communication. */
static volatile sig_atomic_t interrupted, at_once;
static const char *volatile last_words;
static const char *volatile own_folder;

/* Handles a signal by calls that POSIX allows in a handler. */
static void on_signal(int number) {
    (void)number;
    if (!at_once) {
        interrupted = 1;
        return;
    }
    const char *text = last_words, *folder = own_folder;
    ssize_t written = write(STDERR_FILENO, text, strlen(text));
    (void)written;
    if (folder) (void)rmdir(folder);
    _exit(GNEISS_INTERRUPTED);
}

static void catch_signals(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = (int)SA_RESETHAND; /* a second Ctrl-C ends the program at once */
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        if (sigaction(numbers[k], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(numbers[k], &action, NULL);
    signal(SIGPIPE, SIG_IGN); /* a closed pipe does not end a run */
}

void gn_signals_end_at_once(const char *message, const char *folder) {
    last_words = message;
    own_folder = folder;
    at_once = 1;
    catch_signals();
}

const volatile sig_atomic_t *gn_signals_set_flag(void) {
    at_once = 0;
    catch_signals();
    return &interrupted;
}

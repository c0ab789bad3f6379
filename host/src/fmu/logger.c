/* The logger callback of FMI 2.0: formats the variadic message and hands it to the host. */

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* What componentEnvironment points to; mirrors `Environment` in log.rs. */
struct environment {
    void (*receive)(void *environment, int status, const char *category, const char *message);
};

void flexarm_fmi2_log(void *environment, const char *instance, int status, const char *category,
                      const char *message, ...) {
    char text[4096];
    (void)instance;
    if (!environment || !message) {
        return;
    }
    /* Without a conversion there is nothing to format, and nothing that could go wrong. */
    if (strchr(message, '%')) {
        va_list arguments;
        va_start(arguments, message);
        const int length = vsnprintf(text, sizeof text, message, arguments);
        va_end(arguments);
        message = length < 0 ? message : text;
    }
    ((struct environment *)environment)->receive(environment, status, category, message);
}

/* An FMU for tests, FMI 2.0 and 3.0 in one binary: y = gain * u after each step, and faults on demand.
 * It ends the process if it is called when the standard forbids it: after Fatal at all, after Error otherwise
 * than to reset, read or free it. */

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };
enum { U, Y, GAIN, FAULT, FAULT_TIME, FLAG, LABEL, VECTOR };
enum fault { NONE, FAIL, DIE, REFUSE_STEP, ODD_STATUS, END, RETURN_EARLY, ASYNCHRONOUS, NOT_A_NUMBER, WARN, SLOW, REFUSE_START };

typedef void (*log2_t)(void *, const char *, int, const char *, const char *, ...);
typedef void (*log3_t)(void *, int, const char *, const char *);
typedef struct {
    log2_t logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} callbacks2;

typedef struct {
    double u, y, gain, fault_time, vector[8], time;
    uint64_t size, given_size; /* elements of vector; what follows when it is configured */
    int fault;
    char label[64];
    int configuring, failed, pending, states, warnings;
    const callbacks2 *callbacks;
    void *environment;
    log3_t log;
} mock;

static int fatal;

static void legal(const mock *m, int after_error) {
    if (fatal || (m && m->failed && !after_error)) {
        fputs("mock: illegal call\n", stderr);
        abort();
    }
}

static void start(mock *m) {
    m->u = m->y = m->time = 0;
    m->gain = 1;
    m->fault = NONE;
    m->fault_time = 0;
    for (int i = 0; i < 8; i++) m->vector[i] = 1;
    m->size = m->given_size = 3, m->configuring = 0;
    strcpy(m->label, "none");
    m->failed = m->pending = 0;
}

/* The folder must be there, whatever its path is. */
static int has_resource(const char *folder) {
    char path[4096];
    snprintf(path, sizeof path, "%s/hello.txt", folder);
    FILE *file = fopen(path, "r");
    if (file) {
        fclose(file);
    }
    return file != NULL;
}

static void decode(char *to, const char *uri) {
    const char *from = strncmp(uri, "file://", 7) ? uri : uri + 7;
    for (; *from; from++) {
        unsigned byte;
        if (*from == '%' && sscanf(from + 1, "%2x", &byte) == 1) {
            *to++ = (char)byte;
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    *to = 0;
}

/* Warnings are off until they are asked for, and nothing else may be asked for. */
static int set_debug_logging(mock *m, int on, size_t n, const char *const *categories) {
    legal(m, 0);
    for (size_t i = 0; i < n; i++) {
        if (!strcmp(categories[i], "logStatusFatal")) {
            m->failed = 1;
            return ERROR;
        }
        m->warnings |= on && !strcmp(categories[i], "logStatusWarning");
    }
    return OK;
}

static int warns(const mock *m) { return m->warnings && m->fault == WARN; }

static int step(mock *m, double time, double size) {
    const int now = m->fault != NONE && time + size / 2 >= m->fault_time;
    m->time = time;
    if (now) {
        switch ((enum fault)m->fault) {
        case FAIL: m->failed = 1; return ERROR;
        case DIE: fatal = 1; return FATAL;
        case REFUSE_STEP: case END: return DISCARD;
        case ODD_STATUS: m->failed = 1; return 99;
        case ASYNCHRONOUS: m->pending = 3; break;
        case NOT_A_NUMBER: m->y = NAN; return OK;
        case SLOW: usleep(300000); break;
        default: break;
        }
    }
    m->y = m->gain * m->u;
    m->time = time + size;
    return now && m->fault == ASYNCHRONOUS ? PENDING : OK;
}

/* FMI 2.0 */

void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                      const callbacks2 *callbacks, int visible, int logging) {
    char folder[4096];
    (void)visible, (void)logging;
    legal(NULL, 0);
    if (type != 1 || strcmp(token, "mock-token")) {
        callbacks->logger(callbacks->environment, name, ERROR, "logStatusError",
                          "token \"%s\" is not mine, type %d", token, type);
        return NULL;
    }
    decode(folder, resources);
    if (!has_resource(folder)) {
        callbacks->logger(callbacks->environment, name, ERROR, "logStatusError", "no %s", folder);
        return NULL;
    }
    mock *m = callbacks->allocate(1, sizeof *m);
    start(m);
    m->callbacks = callbacks;
    callbacks->logger(callbacks->environment, name, OK, "logEvents", "100% ready");
    return m;
}
void fmi2FreeInstance(mock *m) { legal(m, 1); m->callbacks->release(m); }
int fmi2SetDebugLogging(mock *m, int on, size_t n, const char *const *c) { return set_debug_logging(m, on, n, c); }
int fmi2SetupExperiment(mock *m, int d, double t, double s, int e, double p) {
    (void)d, (void)t, (void)s, (void)e, (void)p;
    legal(m, 0);
    return OK;
}
int fmi2EnterInitializationMode(mock *m) { legal(m, 0); return OK; }
int fmi2ExitInitializationMode(mock *m) {
    legal(m, 0);
    if (m->fault != REFUSE_START) {
        return OK;
    }
    m->failed = 1;
    m->callbacks->logger(m->callbacks->environment, m->label, ERROR, "logStatusError",
                         "fmi2ExitInitializationMode: gain = %g is too much", m->gain);
    return ERROR;
}
int fmi2Terminate(mock *m) { legal(m, 0); return OK; }
int fmi2Reset(mock *m) { legal(m, 1); start(m); return OK; }
static double *real(mock *m, unsigned r) {
    switch (r) {
    case U: return &m->u;
    case Y: return &m->y;
    case GAIN: return &m->gain;
    default: return &m->fault_time;
    }
}
int fmi2GetReal(mock *m, const unsigned *r, size_t n, double *v) {
    legal(m, 1);
    for (size_t i = 0; i < n; i++) v[i] = *real(m, r[i]);
    return OK;
}
int fmi2SetReal(mock *m, const unsigned *r, size_t n, const double *v) {
    legal(m, 0);
    for (size_t i = 0; i < n; i++) *real(m, r[i]) = v[i];
    return OK;
}
int fmi2GetInteger(mock *m, const unsigned *r, size_t n, int *v) {
    (void)r;
    legal(m, 1);
    for (size_t i = 0; i < n; i++) v[i] = m->fault;
    return OK;
}
int fmi2SetInteger(mock *m, const unsigned *r, size_t n, const int *v) {
    (void)r;
    legal(m, 0);
    for (size_t i = 0; i < n; i++) m->fault = v[i];
    return OK;
}
int fmi2GetBoolean(mock *m, const unsigned *r, size_t n, int *v) {
    (void)r;
    legal(m, 1);
    for (size_t i = 0; i < n; i++) v[i] = 256;
    return WARNING;
}
int fmi2SetBoolean(mock *m, const unsigned *r, size_t n, const int *v) {
    (void)r, (void)n, (void)v;
    legal(m, 0);
    return OK;
}
int fmi2SetString(mock *m, const unsigned *r, size_t n, const char *const *v) {
    (void)r;
    legal(m, 0);
    for (size_t i = 0; i < n; i++) snprintf(m->label, sizeof m->label, "%s", v[i]);
    return OK;
}
int fmi2DoStep(mock *m, double time, double size, int final) {
    (void)final;
    legal(m, 0);
    const int status = step(m, time, size);
    if (warns(m)) {
        m->callbacks->logger(m->callbacks->environment, m->label, WARNING, "logStatusWarning", "warm at %g", time);
    }
    if (status == ERROR) {
        m->callbacks->logger(m->callbacks->environment, m->label, ERROR, "logStatusError",
                             "%s failed at %g", m->label, time);
    }
    return status;
}
int fmi2GetStatus(mock *m, int kind, int *v) {
    (void)kind;
    legal(m, 0);
    *v = m->pending-- > 0 ? PENDING : OK;
    return OK;
}
int fmi2GetRealStatus(mock *m, int kind, double *v) { (void)kind; legal(m, 0); *v = m->time; return OK; }
int fmi2GetBooleanStatus(mock *m, int kind, int *v) { (void)kind; legal(m, 0); *v = m->fault == END; return OK; }

/* FMI 3.0 */

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                  bool logging, bool events, bool early, const unsigned *r, size_t n,
                                  void *environment, log3_t log, void *update) {
    (void)name, (void)visible, (void)logging, (void)early, (void)r, (void)n, (void)update;
    legal(NULL, 0);
    const size_t length = strlen(resources);
    if (strcmp(token, "mock-token") || events || !has_resource(resources) || resources[length - 1] != '/') {
        log(environment, ERROR, "logStatusError", "token or resources are not mine");
        return NULL;
    }
    mock *m = calloc(1, sizeof *m);
    start(m);
    m->environment = environment;
    m->log = log;
    return m;
}
void fmi3FreeInstance(mock *m) {
    legal(m, 1);
    if (m->states) {
        fputs("mock: a state was not freed\n", stderr);
        abort();
    }
    free(m);
}
/* States: FMI 3.0 only, so that a host meets an FMU without them too. */
int fmi3GetFMUState(mock *m, mock **state) {
    legal(m, 0);
    *state = malloc(sizeof *m);
    **state = *m;
    m->states++;
    return OK;
}
int fmi3SetFMUState(mock *m, const mock *state) {
    const int states = m->states;
    legal(m, 1);
    *m = *state;
    m->states = states;
    return OK;
}
int fmi3FreeFMUState(mock *m, mock **state) { legal(m, 1); free(*state); *state = NULL; m->states--; return OK; }
int fmi3SerializedFMUStateSize(mock *m, const mock *state, size_t *size) { (void)state; legal(m, 0); *size = sizeof *m; return OK; }
int fmi3SerializeFMUState(mock *m, const mock *state, unsigned char *bytes, size_t size) { legal(m, 0); memcpy(bytes, state, size); return OK; }
int fmi3DeserializeFMUState(mock *m, const unsigned char *bytes, size_t size, mock **state) {
    legal(m, 0);
    *state = malloc(size);
    memcpy(*state, bytes, size);
    m->states++;
    return OK;
}
int fmi3SetDebugLogging(mock *m, bool on, size_t n, const char *const *c) { return set_debug_logging(m, on, n, c); }
int fmi3EnterInitializationMode(mock *m, bool d, double t, double s, bool e, double p) {
    (void)d, (void)t, (void)s, (void)e, (void)p;
    legal(m, 0);
    return OK;
}
int fmi3ExitInitializationMode(mock *m) {
    legal(m, 0);
    if (m->fault != REFUSE_START) {
        return OK;
    }
    m->failed = 1;
    return ERROR;
}
int fmi3Terminate(mock *m) { legal(m, 0); return OK; }
int fmi3Reset(mock *m) { legal(m, 1); start(m); return OK; }
int fmi3GetFloat64(mock *m, const unsigned *r, size_t n, double *v, size_t nv) {
    legal(m, 1);
    for (size_t i = 0, k = 0; i < n && k < nv; i++) {
        if (r[i] == VECTOR) {
            if (m->configuring || nv - k < m->size) return ERROR;
            memcpy(v + k, m->vector, m->size * sizeof *v);
            k += m->size;
        } else {
            v[k++] = *real(m, r[i]);
        }
    }
    return OK;
}
int fmi3SetFloat64(mock *m, const unsigned *r, size_t n, const double *v, size_t nv) {
    legal(m, 0);
    for (size_t i = 0, k = 0; i < n && k < nv; i++) {
        if (r[i] == VECTOR) {
            if (m->configuring || nv - k < m->size) return ERROR;
            memcpy(m->vector, v + k, m->size * sizeof *v);
            k += m->size;
        } else {
            *real(m, r[i]) = v[k++];
        }
    }
    return OK;
}
int fmi3EnterConfigurationMode(mock *m) { legal(m, 0); m->configuring = 1; return OK; }
int fmi3ExitConfigurationMode(mock *m) {
    legal(m, 0);
    if (!m->configuring) return ERROR;
    m->size = m->given_size, m->configuring = 0;
    return OK;
}
int fmi3GetUInt64(mock *m, const unsigned *r, size_t n, uint64_t *v, size_t nv) {
    (void)r, (void)n, (void)nv;
    legal(m, 1);
    *v = m->given_size;
    return OK;
}
int fmi3SetUInt64(mock *m, const unsigned *r, size_t n, const uint64_t *v, size_t nv) {
    (void)r, (void)n, (void)nv;
    legal(m, 0);
    if (!m->configuring) return ERROR;
    m->given_size = *v;
    return OK;
}
int fmi3GetInt32(mock *m, const unsigned *r, size_t n, int32_t *v, size_t nv) { (void)nv; return fmi2GetInteger(m, r, n, v); }
int fmi3SetInt32(mock *m, const unsigned *r, size_t n, const int32_t *v, size_t nv) { (void)nv; return fmi2SetInteger(m, r, n, v); }
int fmi3GetBoolean(mock *m, const unsigned *r, size_t n, unsigned char *v, size_t nv) {
    (void)r, (void)nv;
    legal(m, 1);
    for (size_t i = 0; i < n; i++) v[i] = 200;
    return OK;
}
int fmi3SetString(mock *m, const unsigned *r, size_t n, const char *const *v, size_t nv) { (void)nv; return fmi2SetString(m, r, n, v); }
int fmi3DoStep(mock *m, double time, double size, bool final, bool *event, bool *end, bool *early, double *last) {
    legal(m, 0);
    if (final == (m->states > 0)) {
        fputs("mock: wrong promise about restored states\n", stderr);
        abort();
    }
    const int status = step(m, time, size);
    const int now = m->fault != NONE && time + size / 2 >= m->fault_time;
    *event = false;
    *end = now && m->fault == END;
    *early = now && m->fault == RETURN_EARLY;
    *last = *early ? time + size / 2 : m->time;
    if (warns(m)) {
        char text[64];
        snprintf(text, sizeof text, "warm at %g", time);
        m->log(m->environment, WARNING, "logStatusWarning", text);
    }
    if (status == ERROR) {
        char text[128];
        snprintf(text, sizeof text, "%s failed at %g", m->label, time);
        m->log(m->environment, ERROR, "logStatusError", text);
    }
    return status == PENDING || *end ? OK : status;
}

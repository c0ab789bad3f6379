/* A vendor's arm, FMI 2.0 for Co-Simulation: an angle in degrees counted the other way round, Coulomb friction that
 * holds it at rest, no cogging. It fails when told to. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TAU, PHI_DEG, INERTIA, DAMPING, STIFFNESS, REST_DEG, FRICTION, FAIL_TIME, COUNT };
enum { OK, WARNING, DISCARD, ERROR, FATAL };

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    logger_t logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} callbacks_t;

typedef struct {
    double v[COUNT], angle, velocity;
    const callbacks_t *callbacks;
    char name[64];
} arm;

void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                      const callbacks_t *callbacks, int visible, int logging) {
    (void)type, (void)token, (void)resources, (void)visible, (void)logging;
    arm *a = callbacks->allocate(1, sizeof *a);
    const double start[COUNT] = {0, 0, 0.5, 0.4, 6, 10, 0.3, 1e9};
    memcpy(a->v, start, sizeof start);
    a->callbacks = callbacks;
    snprintf(a->name, sizeof a->name, "%s", name);
    return a;
}
void fmi2FreeInstance(arm *a) { a->callbacks->release(a); }
int fmi2SetDebugLogging(arm *a, int on, size_t n, const char *const *c) { (void)a, (void)on, (void)n, (void)c; return OK; }
int fmi2SetupExperiment(arm *a, int d, double t, double s, int e, double p) {
    (void)a, (void)d, (void)t, (void)s, (void)e, (void)p;
    return OK;
}
int fmi2EnterInitializationMode(arm *a) { (void)a; return OK; }
int fmi2ExitInitializationMode(arm *a) { (void)a; return OK; }
int fmi2Terminate(arm *a) { (void)a; return OK; }
int fmi2Reset(arm *a) { a->angle = a->velocity = 0; return OK; }
int fmi2GetReal(arm *a, const unsigned *r, size_t n, double *v) {
    for (size_t i = 0; i < n; i++) v[i] = r[i] == PHI_DEG ? a->angle * 180 / M_PI : a->v[r[i]];
    return OK;
}
int fmi2SetReal(arm *a, const unsigned *r, size_t n, const double *v) {
    for (size_t i = 0; i < n; i++) a->v[r[i]] = v[i];
    return OK;
}
/* There are no variables of these types. */
int fmi2GetInteger(arm *a, const unsigned *r, size_t n, int *v) { (void)a, (void)r, (void)n, (void)v; return OK; }
int fmi2SetInteger(arm *a, const unsigned *r, size_t n, const int *v) { (void)a, (void)r, (void)n, (void)v; return OK; }
int fmi2GetBoolean(arm *a, const unsigned *r, size_t n, int *v) { (void)a, (void)r, (void)n, (void)v; return OK; }
int fmi2SetBoolean(arm *a, const unsigned *r, size_t n, const int *v) { (void)a, (void)r, (void)n, (void)v; return OK; }
int fmi2SetString(arm *a, const unsigned *r, size_t n, const char *const *v) { (void)a, (void)r, (void)n, (void)v; return OK; }
int fmi2GetStatus(arm *a, int kind, int *v) { (void)a, (void)kind, (void)v; return DISCARD; }
int fmi2GetRealStatus(arm *a, int kind, double *v) { (void)a, (void)kind, (void)v; return DISCARD; }
int fmi2GetBooleanStatus(arm *a, int kind, int *v) { (void)a, (void)kind, (void)v; return DISCARD; }

int fmi2DoStep(arm *a, double time, double size, int final) {
    const int substeps = 10;
    const double h = size / substeps, *v = a->v;
    (void)final;
    if (time >= v[FAIL_TIME]) {
        a->callbacks->logger(a->callbacks->environment, a->name, ERROR, "logStatusError", "the drive tripped");
        return ERROR;
    }
    for (int i = 0; i < substeps; i++) {
        const double spring = v[STIFFNESS] * (a->angle - v[REST_DEG] * M_PI / 180);
        const double pull = v[TAU] - v[DAMPING] * a->velocity - spring;
        if (a->velocity == 0 && fabs(pull) <= v[FRICTION]) {
            continue;
        }
        const double direction = a->velocity != 0 ? a->velocity : pull;
        const double next = a->velocity + h * (pull - copysign(v[FRICTION], direction)) / v[INERTIA];
        a->velocity = next * direction < 0 ? 0 : next;
        a->angle += h * a->velocity;
    }
    return OK;
}

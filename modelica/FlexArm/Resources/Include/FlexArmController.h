/* The controller of FlexArm.Components.Controller: a packaged binary, driven through FMI 2.0 for Co-Simulation.
 *
 * The binary is loaded at run time and not linked. Its exported names are those of every FMU, and a tool that exports or imports
 * FMUs would confuse them. */
#ifndef FLEXARM_CONTROLLER_H
#define FLEXARM_CONTROLLER_H

#include "ModelicaUtilities.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#define FLEXARM_BINARY "/win64/FlexArmController.dll"
#define FLEXARM_OPEN(path) ((void *)LoadLibraryA(path))
#define FLEXARM_SYMBOL(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define FLEXARM_CLOSE(library) FreeLibrary((HMODULE)(library))
#else
#include <dlfcn.h>
#if defined(__aarch64__)
#define FLEXARM_BINARY "/aarch64-linux/libFlexArmController.so"
#else
#define FLEXARM_BINARY "/linux64/libFlexArmController.so"
#endif
#define FLEXARM_OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FLEXARM_SYMBOL(library, name) dlsym(library, name)
#define FLEXARM_CLOSE(library) dlclose(library)
#endif

/* Types of FMI 2.0 sec 2.1.2 and 2.1.5, under names of their own: the tool may know its header too. */
typedef void *FlexArm_component;
typedef void (*FlexArm_logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
  FlexArm_logger logger;
  void *(*allocateMemory)(size_t, size_t);
  void (*freeMemory)(void *);
  void (*stepFinished)(void *, int);
  void *environment;
} FlexArm_callbacks;

/* X(result, function, arguments) */
#define FLEXARM_FUNCTIONS(X)                                                                                              \
  X(FlexArm_component, Instantiate, (const char *, int, const char *, const char *, const FlexArm_callbacks *, int, int)) \
  X(void, FreeInstance, (FlexArm_component))                                                                              \
  X(int, SetupExperiment, (FlexArm_component, int, double, double, int, double))                                          \
  X(int, EnterInitializationMode, (FlexArm_component))                                                                    \
  X(int, ExitInitializationMode, (FlexArm_component))                                                                     \
  X(int, SetReal, (FlexArm_component, const unsigned *, size_t, const double *))                                          \
  X(int, SetInteger, (FlexArm_component, const unsigned *, size_t, const int *))                                          \
  X(int, SetBoolean, (FlexArm_component, const unsigned *, size_t, const int *))                                          \
  X(int, GetReal, (FlexArm_component, const unsigned *, size_t, double *))                                                \
  X(int, GetInteger, (FlexArm_component, const unsigned *, size_t, int *))                                                \
  X(int, DoStep, (FlexArm_component, double, double, int))                                                                \
  X(int, Terminate, (FlexArm_component))

enum { FLEXARM_MOST_OUTPUTS = 64, FLEXARM_INPUTS = 2 };

typedef struct {
  void *library;
  FlexArm_component component;
  FlexArm_callbacks callbacks;
#define FLEXARM_FIELD(result, name, arguments) result(*name) arguments;
  FLEXARM_FUNCTIONS(FLEXARM_FIELD)
#undef FLEXARM_FIELD
  double period;
  /* Instant of the first sample, wherever the simulation starts. */
  double first;
  /* Samples taken: instants are first + taken*period, never a sum of steps. The binary counts its time from the first one. */
  long taken;
  unsigned inputs[FLEXARM_INPUTS], reals[FLEXARM_MOST_OUTPUTS], integers[FLEXARM_MOST_OUTPUTS];
  /* What the binary said last; it says why before it fails. */
  char message[2048];
} FlexArm_controller;

static void FlexArm_log(void *environment, const char *instance, int status, const char *category, const char *format, ...) {
  FlexArm_controller *self = (FlexArm_controller *)environment;
  va_list arguments;
  (void)instance;
  (void)category;
  if (self == NULL || status < 1) /* fmi2OK */
    return;
  va_start(arguments, format);
  vsnprintf(self->message, sizeof self->message, format, arguments);
  va_end(arguments);
}

static void FlexArmController_free(void *object) {
  FlexArm_controller *self = (FlexArm_controller *)object;
  if (self == NULL)
    return;
  if (self->component != NULL)
    self->FreeInstance(self->component);
  if (self->library != NULL)
    FLEXARM_CLOSE(self->library);
  free(self);
}

/* Frees everything and ends the simulation: ModelicaFormatError does not return. */
static void FlexArm_fail(FlexArm_controller *self, const char *what) {
  char message[sizeof self->message];
  memcpy(message, self->message, sizeof message);
  FlexArmController_free(self);
  ModelicaFormatError("FlexArm controller: %s failed: %s", what, message[0] != '\0' ? message : "no reason given");
}

static void FlexArm_references(unsigned *to, const int *from, size_t count) {
  size_t i;
  for (i = 0; i < count; i++)
    to[i] = (unsigned)from[i];
}

static void *FlexArmController_new(
    const char *libraries, const char *token, double period,
    const int *inputs, size_t inputCount, const int *realOutputs, size_t realOutputCount,
    const int *integerOutputs, size_t integerOutputCount,
    const int *realReferences, const double *reals, size_t realCount,
    const int *integerReferences, const int *integers, size_t integerCount,
    const int *booleanReferences, const int *booleans, size_t booleanCount) {
  FlexArm_controller *self = (FlexArm_controller *)calloc(1, sizeof *self);
  const char *failed = NULL;
  if (self == NULL) {
    ModelicaFormatError("FlexArm controller: out of memory");
    return NULL;
  }
  self->period = period;
  if (inputCount != FLEXARM_INPUTS || realOutputCount > FLEXARM_MOST_OUTPUTS || integerOutputCount > FLEXARM_MOST_OUTPUTS) {
    snprintf(self->message, sizeof self->message, "header and package are of different versions");
    FlexArm_fail(self, "set-up");
    return NULL;
  }
  FlexArm_references(self->inputs, inputs, inputCount);
  FlexArm_references(self->reals, realOutputs, realOutputCount);
  FlexArm_references(self->integers, integerOutputs, integerOutputCount);

  snprintf(self->message, sizeof self->message, "%s%s", libraries, FLEXARM_BINARY);
  self->library = FLEXARM_OPEN(self->message);
  if (self->library == NULL) {
    FlexArm_fail(self, "loading the binary of this platform");
    return NULL;
  }
#define FLEXARM_LOAD(result, name, arguments)                       \
  *(void **)&self->name = FLEXARM_SYMBOL(self->library, "fmi2" #name); \
  if (self->name == NULL)                                           \
    failed = "loading fmi2" #name;
  FLEXARM_FUNCTIONS(FLEXARM_LOAD)
#undef FLEXARM_LOAD
  if (failed != NULL) {
    FlexArm_fail(self, failed);
    return NULL;
  }
  self->message[0] = '\0';

  self->callbacks.logger = FlexArm_log;
  self->callbacks.allocateMemory = calloc;
  self->callbacks.freeMemory = free;
  self->callbacks.environment = self;
  self->component = self->Instantiate("FlexArmController", 1, token, "", &self->callbacks, 0, 1);
  if (self->component == NULL) {
    FlexArm_fail(self, "instantiation");
    return NULL;
  }
/* References are non-negative: int and unsigned agree. Status 1 is a warning. */
#define FLEXARM_SET(kind, references, values, count) \
  ((count) > 0 && self->Set##kind(self->component, (const unsigned *)(references), count, values) > 1)
  if (FLEXARM_SET(Real, realReferences, reals, realCount) ||
      FLEXARM_SET(Integer, integerReferences, integers, integerCount) ||
      FLEXARM_SET(Boolean, booleanReferences, booleans, booleanCount))
    failed = "setting parameters";
  else if (self->SetupExperiment(self->component, 0, 0.0, 0.0, 0, 0.0) > 1 ||
           self->EnterInitializationMode(self->component) > 1 || self->ExitInitializationMode(self->component) > 1)
    failed = "initialisation";
#undef FLEXARM_SET
  if (failed != NULL) {
    FlexArm_fail(self, failed);
    return NULL;
  }
  return self;
}

static void FlexArmController_sample(
    void *object, double now, const double *inputs, size_t inputCount,
    double *reals, size_t realCount, int *integers, size_t integerCount) {
  FlexArm_controller *self = (FlexArm_controller *)object;
  double elapsed = (double)self->taken * self->period;
  (void)inputCount;
  if (self->taken == 0)
    self->first = now;
  /* Before the next instant: an event iteration at the one before. */
  if (now > self->first + elapsed - 0.5 * self->period) {
    if (self->SetReal(self->component, self->inputs, FLEXARM_INPUTS, inputs) > 1 ||
        self->DoStep(self->component, elapsed, self->period, 1) > 1) {
      ModelicaFormatError("FlexArm controller: the sample at %.9g s failed: %s", now, self->message);
      return;
    }
    self->taken++;
  }
  if (self->GetReal(self->component, self->reals, realCount, reals) > 1 ||
      self->GetInteger(self->component, self->integers, integerCount, integers) > 1)
    ModelicaFormatError("FlexArm controller: outputs at %.9g s: %s", now, self->message);
}

#endif

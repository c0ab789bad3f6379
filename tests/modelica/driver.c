/* The controller's header as a Modelica tool compiles it: its functions with external names, for a caller by their names,
 * and an error that does not return. */
#include "FlexArmController.h"
#include <setjmp.h>

static jmp_buf failed;
static char reason[2048];

void ModelicaFormatError(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  longjmp(failed, 1);
}

const char *why(void) { return reason; }

/* NULL if the constructor failed. */
void *construct(const char *libraries, const char *token, double period, const int *inputs, const int *reals,
                size_t realCount, const int *integers, size_t integerCount, const int *realReferences, const double *realValues,
                size_t realParameters, const int *integerReferences, const int *integerValues, size_t integerParameters,
                const int *booleanReferences, const int *booleanValues, size_t booleanParameters) {
  if (setjmp(failed) != 0)
    return NULL;
  return FlexArmController_new(libraries, token, period, inputs, 2, reals, realCount, integers, integerCount,
                               realReferences, realValues, realParameters, integerReferences, integerValues, integerParameters,
                               booleanReferences, booleanValues, booleanParameters);
}

/* 1 if it failed. */
int take(void *object, double now, const double *inputs, double *reals, size_t realCount, int *integers, size_t integerCount) {
  if (setjmp(failed) != 0)
    return 1;
  FlexArmController_sample(object, now, inputs, 2, reals, realCount, integers, integerCount);
  return 0;
}

void destroy(void *object) { FlexArmController_free(object); }

/* The controller's header in a program of its own, for platforms whose Python is not at hand.
 *
 *     samples LIBRARIES COUNT < numbers
 *
 * reads the token, the lists that the constructor takes, each with its length before it, and for each of COUNT samples
 * the time, the angle and the setpoint. Prints the outputs of each in a line, exactly. Exits with 1 and the reason if a call
 * fails. */
#include <stdio.h>
#include <stdlib.h>

extern void *construct(const char *, const char *, double, const int *, const int *, size_t, const int *, size_t, const int *,
                       const double *, size_t, const int *, const int *, size_t, const int *, const int *, size_t);
extern int take(void *, double, const double *, double *, size_t, int *, size_t);
extern void destroy(void *);
extern const char *why(void);

enum { MOST = 1000 };

static void __attribute__((noreturn)) fail(const char *reason) {
  fprintf(stderr, "%s\n", reason);
  exit(1);
}

static size_t length(void) {
  unsigned count;
  if (scanf("%u", &count) != 1 || count > MOST)
    fail("a list has no length or too large a one");
  return count;
}

/* A function that reads a list of a type and returns its length. */
#define READER(name, type, format)                 \
  static size_t name(type *values) {               \
    size_t i, count = length();                    \
    for (i = 0; i < count; i++)                    \
      if (scanf(format, &values[i]) != 1)          \
        fail("a number of a list is missing");     \
    return count;                                  \
  }
READER(integers, int, "%d")
READER(reals, double, "%lf")
#undef READER

int main(int argc, char **argv) {
  static int inputs[MOST], realOutputs[MOST], integerOutputs[MOST], references[3][MOST], values[2][MOST], integerResults[MOST];
  static double realValues[MOST], realResults[MOST];
  char token[100];
  double period, now, in[2];
  size_t i, realCount, integerCount, counts[3];
  long k, samples;
  void *controller;
  if (argc != 3 || scanf("%99s %lf", token, &period) != 2)
    fail("usage: samples LIBRARIES COUNT < numbers");
  samples = atol(argv[2]);
  integers(inputs);
  realCount = integers(realOutputs);
  integerCount = integers(integerOutputs);
  counts[0] = integers(references[0]);
  reals(realValues);
  counts[1] = integers(references[1]);
  integers(values[0]);
  counts[2] = integers(references[2]);
  integers(values[1]);
  controller = construct(argv[1], token, period, inputs, realOutputs, realCount, integerOutputs, integerCount,
                         references[0], realValues, counts[0], references[1], values[0], counts[1], references[2], values[1], counts[2]);
  if (controller == NULL)
    fail(why());
  for (k = 0; k < samples; k++) {
    if (scanf("%lf %lf %lf", &now, &in[0], &in[1]) != 3)
      fail("a sample is missing");
    if (take(controller, now, in, realResults, realCount, integerResults, integerCount))
      fail(why());
    for (i = 0; i < realCount; i++)
      printf("%a ", realResults[i]);
    for (i = 0; i < integerCount; i++)
      printf("%d ", integerResults[i]);
    printf("\n");
  }
  destroy(controller);
  return 0;
}

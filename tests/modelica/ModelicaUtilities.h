/* What a Modelica tool gives to external functions, as far as the controller's header needs it. */
#ifndef MODELICA_UTILITIES_H
#define MODELICA_UTILITIES_H
void ModelicaFormatError(const char *format, ...);
#endif

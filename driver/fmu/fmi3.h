/** Binary interface of an FMU by the Functional Mock-up Interface 3.0, written from the standard: types, and the
 *  functions that importers look up by name. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMI3_API __attribute__((visibility("default")))
#define FMI3_VERSION "3.0"

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void fmi3LogMessageCallback(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void fmi3ClockUpdateCallback(fmi3InstanceEnvironment);
typedef void fmi3IntermediateUpdateCallback(fmi3InstanceEnvironment, fmi3Float64 time, fmi3Boolean set_requested,
                                            fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                            fmi3Boolean can_return_early, fmi3Boolean *return_requested,
                                            fmi3Float64 *return_time);
typedef void fmi3LockPreemptionCallback(void);
typedef void fmi3UnlockPreemptionCallback(void);

/* ---- instances ---- */

FMI3_API const char *fmi3GetVersion(void);
FMI3_API fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean on, size_t n, const fmi3String categories[]);
FMI3_API fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                   fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment,
                                                   fmi3LogMessageCallback *);
FMI3_API fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                  fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                                  fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                                  size_t n_intermediate, fmi3InstanceEnvironment,
                                                  fmi3LogMessageCallback *, fmi3IntermediateUpdateCallback *);
FMI3_API fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                        fmi3Boolean visible, fmi3Boolean logging,
                                                        fmi3InstanceEnvironment, fmi3LogMessageCallback *,
                                                        fmi3ClockUpdateCallback *, fmi3LockPreemptionCallback *,
                                                        fmi3UnlockPreemptionCallback *);
FMI3_API void fmi3FreeInstance(fmi3Instance);
FMI3_API fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                                fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop);
FMI3_API fmi3Status fmi3ExitInitializationMode(fmi3Instance);
FMI3_API fmi3Status fmi3EnterEventMode(fmi3Instance);
FMI3_API fmi3Status fmi3Terminate(fmi3Instance);
FMI3_API fmi3Status fmi3Reset(fmi3Instance);
FMI3_API fmi3Status fmi3EnterConfigurationMode(fmi3Instance);
FMI3_API fmi3Status fmi3ExitConfigurationMode(fmi3Instance);

/* ---- values ---- */

/** X(type): types whose values are contiguous numbers. */
#define FMI3_PLAIN_TYPES(X)                                                                                            \
    X(Float32) X(Float64) X(Int8) X(UInt8) X(Int16) X(UInt16) X(Int32) X(UInt32) X(Int64) X(UInt64) X(Boolean) X(String)
#define FMI3_DECLARE(type)                                                                                             \
    FMI3_API fmi3Status fmi3Get##type(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3##type values[],         \
                                      size_t n_values);                                                                \
    FMI3_API fmi3Status fmi3Set##type(fmi3Instance, const fmi3ValueReference[], size_t n, const fmi3##type values[],   \
                                      size_t n_values);
FMI3_PLAIN_TYPES(FMI3_DECLARE)
#undef FMI3_DECLARE
FMI3_API fmi3Status fmi3GetBinary(fmi3Instance, const fmi3ValueReference[], size_t n, size_t sizes[],
                                  fmi3Binary values[], size_t n_values);
FMI3_API fmi3Status fmi3SetBinary(fmi3Instance, const fmi3ValueReference[], size_t n, const size_t sizes[],
                                  const fmi3Binary values[], size_t n_values);
FMI3_API fmi3Status fmi3GetClock(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3Clock values[]);
FMI3_API fmi3Status fmi3SetClock(fmi3Instance, const fmi3ValueReference[], size_t n, const fmi3Clock values[]);
FMI3_API fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference, size_t *n);
FMI3_API fmi3Status fmi3GetVariableDependencies(fmi3Instance, fmi3ValueReference, size_t elements[],
                                                fmi3ValueReference independents[], size_t independent_elements[],
                                                fmi3DependencyKind kinds[], size_t n);
FMI3_API fmi3Status fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference unknowns[], size_t n_unknowns,
                                                 const fmi3ValueReference knowns[], size_t n_knowns,
                                                 const fmi3Float64 seed[], size_t n_seed, fmi3Float64 sensitivity[],
                                                 size_t n_sensitivity);
FMI3_API fmi3Status fmi3GetAdjointDerivative(fmi3Instance, const fmi3ValueReference unknowns[], size_t n_unknowns,
                                             const fmi3ValueReference knowns[], size_t n_knowns,
                                             const fmi3Float64 seed[], size_t n_seed, fmi3Float64 sensitivity[],
                                             size_t n_sensitivity);
FMI3_API fmi3Status fmi3GetOutputDerivatives(fmi3Instance, const fmi3ValueReference[], size_t n,
                                             const fmi3Int32 orders[], fmi3Float64 values[], size_t n_values);

/* ---- the complete state ---- */

FMI3_API fmi3Status fmi3GetFMUState(fmi3Instance, fmi3FMUState *);
FMI3_API fmi3Status fmi3SetFMUState(fmi3Instance, fmi3FMUState);
FMI3_API fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState *);
FMI3_API fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, size_t *size);
FMI3_API fmi3Status fmi3SerializeFMUState(fmi3Instance, fmi3FMUState, fmi3Byte bytes[], size_t size);
FMI3_API fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *);

/* ---- clocks ---- */

FMI3_API fmi3Status fmi3GetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3Float64 intervals[],
                                           fmi3IntervalQualifier[]);
FMI3_API fmi3Status fmi3GetIntervalFraction(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3UInt64 counters[],
                                            fmi3UInt64 resolutions[], fmi3IntervalQualifier[]);
FMI3_API fmi3Status fmi3GetShiftDecimal(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3Float64 shifts[]);
FMI3_API fmi3Status fmi3GetShiftFraction(fmi3Instance, const fmi3ValueReference[], size_t n, fmi3UInt64 counters[],
                                         fmi3UInt64 resolutions[]);
FMI3_API fmi3Status fmi3SetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], size_t n,
                                           const fmi3Float64 intervals[]);
FMI3_API fmi3Status fmi3SetIntervalFraction(fmi3Instance, const fmi3ValueReference[], size_t n,
                                            const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);
FMI3_API fmi3Status fmi3SetShiftDecimal(fmi3Instance, const fmi3ValueReference[], size_t n, const fmi3Float64 shifts[]);
FMI3_API fmi3Status fmi3SetShiftFraction(fmi3Instance, const fmi3ValueReference[], size_t n,
                                         const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);
FMI3_API fmi3Status fmi3ActivateModelPartition(fmi3Instance, fmi3ValueReference clock, fmi3Float64 time);

/* ---- model exchange ---- */

FMI3_API fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance);
FMI3_API fmi3Status fmi3UpdateDiscreteStates(fmi3Instance, fmi3Boolean *again, fmi3Boolean *terminate,
                                             fmi3Boolean *nominals_changed, fmi3Boolean *states_changed,
                                             fmi3Boolean *has_next, fmi3Float64 *next);
FMI3_API fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance);
FMI3_API fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean no_set_state, fmi3Boolean *enter_event_mode,
                                                fmi3Boolean *terminate);
FMI3_API fmi3Status fmi3SetTime(fmi3Instance, fmi3Float64 time);
FMI3_API fmi3Status fmi3SetContinuousStates(fmi3Instance, const fmi3Float64 states[], size_t n);
FMI3_API fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance, fmi3Float64 rates[], size_t n);
FMI3_API fmi3Status fmi3GetEventIndicators(fmi3Instance, fmi3Float64 indicators[], size_t n);
FMI3_API fmi3Status fmi3GetContinuousStates(fmi3Instance, fmi3Float64 states[], size_t n);
FMI3_API fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[], size_t n);
FMI3_API fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, size_t *n);
FMI3_API fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, size_t *n);

/* ---- co-simulation ---- */

FMI3_API fmi3Status fmi3EnterStepMode(fmi3Instance);
FMI3_API fmi3Status fmi3DoStep(fmi3Instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_set_state,
                               fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached);

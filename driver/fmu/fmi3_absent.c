/* Functions of the interface that this FMU does not support, as stated in its description: variables other than 64-bit
 * floats, clocks, derivatives of outputs, variable dependencies. Each reports this. */
#include "fmu/fmi3_instance.h"

/* The parameters are those of the standard. NOLINTBEGIN(misc-unused-parameters,readability-non-const-parameter) */

static void refuse(instance *self, void *with)
{
    instance_refuse(self, fmi3Error, "this FMU has no %s", (const char *)with);
}

static fmi3Status absent(fmi3Instance handle, const char *function, char *what)
{
    return instance_call(handle, function, IN_ANY, refuse, what);
}

/** A request for zero values is no error. */
static fmi3Status absent_values(fmi3Instance handle, const char *function, size_t n, char *what)
{
    return n == 0 ? fmi3OK : absent(handle, function, what);
}

#define ABSENT_TYPE(type)                                                                                              \
    fmi3Status fmi3Get##type(fmi3Instance handle, const fmi3ValueReference references[], size_t n,                     \
                             fmi3##type values[], size_t n_values)                                                     \
    {                                                                                                                  \
        return absent_values(handle, "fmi3Get" #type, n, "variables of the type " #type);                              \
    }                                                                                                                  \
    fmi3Status fmi3Set##type(fmi3Instance handle, const fmi3ValueReference references[], size_t n,                     \
                             const fmi3##type values[], size_t n_values)                                               \
    {                                                                                                                  \
        return absent_values(handle, "fmi3Set" #type, n, "variables of the type " #type);                              \
    }
ABSENT_TYPE(Float32)
ABSENT_TYPE(Int8)
ABSENT_TYPE(UInt8)
ABSENT_TYPE(Int16)
ABSENT_TYPE(UInt16)
ABSENT_TYPE(Int32)
ABSENT_TYPE(UInt32)
ABSENT_TYPE(Int64)
ABSENT_TYPE(UInt64)
ABSENT_TYPE(Boolean)
ABSENT_TYPE(String)

fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t n, size_t sizes[],
                         fmi3Binary values[], size_t n_values)
{
    return absent_values(handle, "fmi3GetBinary", n, "binary variables");
}

fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t n, const size_t sizes[],
                         const fmi3Binary values[], size_t n_values)
{
    return absent_values(handle, "fmi3SetBinary", n, "binary variables");
}

fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t n, fmi3Clock values[])
{
    return absent_values(handle, "fmi3GetClock", n, "clocks");
}

fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t n, const fmi3Clock values[])
{
    return absent_values(handle, "fmi3SetClock", n, "clocks");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance handle, fmi3ValueReference reference, size_t *n)
{
    return absent(handle, "fmi3GetNumberOfVariableDependencies", "dependencies that change");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance handle, fmi3ValueReference reference, size_t elements[],
                                       fmi3ValueReference independents[], size_t independent_elements[],
                                       fmi3DependencyKind kinds[], size_t n)
{
    return absent(handle, "fmi3GetVariableDependencies", "dependencies that change");
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[], size_t n_unknowns,
                                        const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    return absent(handle, "fmi3GetDirectionalDerivative", "directional derivatives");
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[], size_t n_unknowns,
                                    const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[],
                                    size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    return absent(handle, "fmi3GetAdjointDerivative", "adjoint derivatives");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t n_values)
{
    return absent_values(handle, "fmi3GetOutputDerivatives", n, "derivatives of outputs");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                  fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    return absent_values(handle, "fmi3GetIntervalDecimal", n, "clocks");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                   fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    return absent_values(handle, "fmi3GetIntervalFraction", n, "clocks");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                               fmi3Float64 shifts[])
{
    return absent_values(handle, "fmi3GetShiftDecimal", n, "clocks");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    return absent_values(handle, "fmi3GetShiftFraction", n, "clocks");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                  const fmi3Float64 intervals[])
{
    return absent_values(handle, "fmi3SetIntervalDecimal", n, "clocks");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                   const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    return absent_values(handle, "fmi3SetIntervalFraction", n, "clocks");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                               const fmi3Float64 shifts[])
{
    return absent_values(handle, "fmi3SetShiftDecimal", n, "clocks");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                                const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    return absent_values(handle, "fmi3SetShiftFraction", n, "clocks");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance handle, fmi3ValueReference clock, fmi3Float64 time)
{
    return absent(handle, "fmi3ActivateModelPartition", "clocks");
}
/* NOLINTEND(misc-unused-parameters,readability-non-const-parameter) */

/* Instances and their modes. */
#include "fmu/fmi3_instance.h"

#include "base/memory.h"
#include "library/boundary.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct {
    instance_mode mode;
    const char *name;
} modes[] = {{IN_INSTANTIATED, "Instantiated"},
             {IN_INITIALIZATION, "Initialization Mode"},
             {IN_EVENT, "Event Mode"},
             {IN_CONTINUOUS, "Continuous-Time Mode"},
             {IN_STEP, "Step Mode"},
             {IN_TERMINATED, "Terminated"},
             {IN_CONFIGURATION, "Configuration Mode"},
             {IN_RUINS, "after a fatal error"}};

static const char *name_of(instance_mode mode)
{
    size_t i = 0;
    while (modes[i].mode != mode) {
        i++;
    }
    return modes[i].name;
}

static void log_text(const instance *self, const char *text)
{
    if (self->log != NULL) { /* errors always; there is nothing to be enabled by fmi3SetDebugLogging */
        self->log(self->environment, self->status, self->status == fmi3Fatal ? "logStatusFatal" : "logStatusError",
                  text);
    }
}

void instance_refuse(instance *self, fmi3Status status, const char *format, ...)
{
    char text[EVL_ERROR_LOCATION_LENGTH + EVL_ERROR_MESSAGE_LENGTH];
    va_list values;
    va_start(values, format);
    (void)vsnprintf(text, sizeof text, format, values);
    va_end(values);
    self->status = status;
    log_text(self, text);
}

bool instance_are_finite(instance *self, size_t n, const double *numbers)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(numbers[i])) {
            instance_refuse(self, fmi3Error, "a number is %g, but must be finite", numbers[i]);
            return false;
        }
    }
    return true;
}

void instance_fail(instance *self, dae_code code)
{
    const evl_error *error = motion_error(self->motion);
    const bool has_location = error->location[0] != '\0';
    instance_refuse(self, code == DAE_RECOVERABLE ? fmi3Discard : fmi3Error, "%s%s%s", error->location,
                    has_location ? ": " : "", error->message);
}

bool instance_begin(instance *self)
{
    if (!self->is_begun) {
        self->is_begun = motion_start(self->motion, self->by_steps, self->t_end);
        if (!self->is_begun) {
            instance_fail(self, DAE_FATAL);
        }
    }
    return self->is_begun;
}

typedef struct {
    instance *self;
    instance_work *work;
    void *with;
} job;

static void do_job(void *with)
{
    const job *j = with;
    j->work(j->self, j->with);
}

fmi3Status instance_call(fmi3Instance handle, const char *function, unsigned allowed, instance_work *work, void *with)
{
    instance *self = handle;
    evl_error error = {.code = EVL_EXIT_OK};
    if (self == NULL) {
        return fmi3Fatal;
    }
    self->status = fmi3OK;
    if (((unsigned)self->mode & allowed) == 0) {
        instance_refuse(self, self->mode == IN_RUINS ? fmi3Fatal : fmi3Error,
                        "%s is not allowed here: the instance is in the state %s", function, name_of(self->mode));
        return self->status;
    }
    boundary_call(do_job, &(job){self, work, with}, &error);
    if (error.code != EVL_EXIT_OK) {
        self->mode = IN_RUINS;
        instance_refuse(self, fmi3Fatal, "%s", error.message);
    }
    return self->status;
}

/* ---- instances ---- */

typedef struct {
    instance as;
    const char *token, *resources;
    instance *made;
    evl_error error;
} making;

static bool read_case(making *m, case_plan *plan)
{
    const size_t n = strlen(m->resources);
    CLEANUP_FREE char *path =
        xasprintf("%s%s%s", m->resources, n > 0 && m->resources[n - 1] == '/' ? "" : "/", FMU_CASE);
    if (!case_plan_make(plan, &(plan_request){.name = path}, &m->error)) {
        return false;
    }
    fmu_token(plan->file, m->as.token);
    return m->token == NULL || strcmp(m->as.token, m->token) == 0 ||
           evl_error_set(&m->error, EVL_EXIT_CASE, path,
                         "the instantiation token is not that of this case and program; build the FMU again");
}

static void make(void *with)
{
    making *m = with;
    case_plan plan = {0};
    if (m->resources == NULL) {
        (void)evl_error_set(&m->error, EVL_EXIT_USAGE, "", "the importer provides no path of the FMU's resources");
    } else if (read_case(m, &plan)) {
        motion *motion = motion_create(&plan, &m->error);
        if (motion != NULL) {
            m->made = xcalloc(1, sizeof *m->made);
            *m->made = m->as;
            m->made->motion = motion;
        }
    }
    case_plan_free(&plan);
}

static instance *instantiate(making *m)
{
    boundary_call(make, m, &m->error);
    if (m->made == NULL) {
        const bool has_location = m->error.location[0] != '\0';
        instance_refuse(&m->as, fmi3Error, "%s%s%s", m->error.location, has_location ? ": " : "", m->error.message);
    }
    return m->made;
}

const char *fmi3GetVersion(void)
{
    return FMI3_VERSION;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback *log)
{
    (void)name, (void)visible, (void)logging;
    return instantiate(
        &(making){.as = {.mode = IN_INSTANTIATED, .t_end = DBL_MAX, .environment = environment, .log = log},
                  .token = token,
                  .resources = resources});
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t n_intermediate,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback *log,
                                         fmi3IntermediateUpdateCallback *update)
{
    (void)name, (void)visible, (void)logging, (void)event_mode, (void)early_return, (void)intermediate,
        (void)n_intermediate;
    (void)update;
    return instantiate(&(making){
        .as = {.mode = IN_INSTANTIATED, .by_steps = true, .t_end = DBL_MAX, .environment = environment, .log = log},
        .token = token,
        .resources = resources});
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback *log,
                                               fmi3ClockUpdateCallback *update, fmi3LockPreemptionCallback *lock,
                                               fmi3UnlockPreemptionCallback *unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    instance_refuse(&(instance){.mode = IN_INSTANTIATED, .environment = environment, .log = log}, fmi3Error,
                    "this FMU is for co-simulation and model exchange, not for scheduled execution");
    return NULL;
}

static void forget(void *with)
{
    instance *self = with;
    if (self->mode != IN_RUINS) {
        motion_delete(&self->motion);
    }
    free(self);
}

void fmi3FreeInstance(fmi3Instance handle)
{
    evl_error error = {.code = EVL_EXIT_OK};
    if (handle != NULL) {
        boundary_call(forget, handle, &error);
    }
}

static void do_nothing(instance *self, void *with)
{
    (void)self, (void)with;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)on, (void)n, (void)categories; /* all messages are errors */
    return instance_call(handle, "fmi3SetDebugLogging", IN_ANY, do_nothing, NULL);
}

/* ---- modes ---- */

typedef struct {
    double start, stop;
    bool has_stop;
} span;

static void initialize(instance *self, void *with)
{
    const span *span = with;
    if (!(fabs(span->start) <= 0)) {
        instance_refuse(self, fmi3Error, "the start time is %.9g s, but a case starts at 0", span->start);
        return;
    }
    if (span->has_stop && !(span->stop > span->start)) {
        instance_refuse(self, fmi3Error, "the stop time is %.9g s, but must be after the start", span->stop);
        return;
    }
    self->t_end = span->has_stop ? fmin(span->stop, DBL_MAX) : DBL_MAX;
    self->is_begun = false;
    self->mode = IN_INITIALIZATION;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    (void)has_tolerance, (void)tolerance; /* the case has a tolerance, in its own units */
    return instance_call(handle, "fmi3EnterInitializationMode", IN_INSTANTIATED, initialize,
                         &(span){start, stop, has_stop});
}

static void leave_initialization(instance *self, void *with)
{
    (void)with;
    if (instance_begin(self)) {
        self->mode = self->by_steps ? IN_STEP : IN_EVENT;
    }
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3ExitInitializationMode", IN_INITIALIZATION, leave_initialization, NULL);
}

static void terminate(instance *self, void *with)
{
    (void)with;
    self->mode = IN_TERMINATED;
}

fmi3Status fmi3Terminate(fmi3Instance handle)
{
    return instance_call(handle, "fmi3Terminate", IN_MOTION, terminate, NULL);
}

static void reset(instance *self, void *with)
{
    (void)with;
    if (!motion_reset(self->motion)) {
        instance_fail(self, DAE_FATAL);
    }
    self->mode = IN_INSTANTIATED;
    self->is_begun = false;
}

fmi3Status fmi3Reset(fmi3Instance handle)
{
    return instance_call(handle, "fmi3Reset", IN_ANY, reset, NULL);
}

static void change_mode(instance *self, void *with)
{
    self->mode = *(const instance_mode *)with;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3EnterConfigurationMode", IN_INSTANTIATED, change_mode,
                         &(instance_mode){IN_CONFIGURATION});
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3ExitConfigurationMode", IN_CONFIGURATION, change_mode,
                         &(instance_mode){IN_INSTANTIATED});
}

#include "importer.h"

#include "base/memory.h"

#include <dlfcn.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define POINTER(name) __typeof__(fmi3##name) *name;
CALLS(POINTER)
#undef POINTER

gearbox gearboxes[N_GEARBOXES] = {
    {"examples/paper.yaml", 1, {"meshes.0.tracking=closed_form"}, "", 0},
    {"examples/rattle.yaml", 0, {NULL}, "", 0},
    {"examples/compliant-pair.yaml", 0, {NULL}, "", 0},
};

char logged[4096];
int n_logged;

void hear(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text)
{
    assert_null(environment);
    assert_true(status >= fmi3Discard);
    assert_non_null(category);
    assert_null(strchr(text, '\n'));
    (void)snprintf(logged, sizeof logged, "%s", text);
    n_logged++;
}

int set_up(void **state)
{
    (void)state;
    void *binary = dlopen(FMU_BINARY_PATH, RTLD_NOW | RTLD_LOCAL);
    if (binary == NULL) {
        fail_msg("%s", dlerror());
    }
#define LOOK_UP(name) *(void **)&name = dlsym(binary, "fmi3" #name);
    CALLS(LOOK_UP)
#undef LOOK_UP
    for (int i = 0; i < N_GEARBOXES; i++) {
        gearbox *g = &gearboxes[i];
        case_plan plan = {0};
        evl_error error = {.code = EVL_EXIT_OK};
        (void)snprintf(g->folder, sizeof g->folder, "/tmp/evolvent-fmi3-XXXXXX");
        assert_non_null(mkdtemp(g->folder));
        CLEANUP_FREE char *path = xasprintf("%s/" FMU_CASE, g->folder);
        assert_true(case_plan_make(&plan, &(plan_request){.name = g->path, .n_set = g->n_set, .set = g->set}, &error));
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        (void)fputs(case_text(plan.file), file);
        assert_int_equal(fclose(file), 0);
        motion *m = motion_create(&plan, &error);
        assert_non_null(m);
        g->n_outputs = motion_about(m)->plan->n_values;
        motion_delete(&m);
    }
    return 0;
}

int tear_down(void **state)
{
    (void)state;
    for (int i = 0; i < N_GEARBOXES; i++) {
        CLEANUP_FREE char *path = xasprintf("%s/" FMU_CASE, gearboxes[i].folder);
        (void)remove(path);
        (void)rmdir(gearboxes[i].folder);
    }
    return 0;
}

fmi3Instance make(int which, bool by_steps)
{
    const char *folder = gearboxes[which].folder;
    fmi3Instance made =
        by_steps ? InstantiateCoSimulation("one", NULL, folder, false, false, false, false, NULL, 0, NULL, hear, NULL)
                 : InstantiateModelExchange("one", NULL, folder, false, false, NULL, hear);
    assert_non_null(made);
    return made;
}

void begin(fmi3Instance fmu)
{
    assert_int_equal(EnterInitializationMode(fmu, false, 0, 0, false, 0), fmi3OK);
    assert_int_equal(ExitInitializationMode(fmu), fmi3OK);
}

fmi3Status step(fmi3Instance fmu, double t, double h)
{
    bool event, terminate, early;
    double reached;
    const fmi3Status status = DoStep(fmu, t, h, true, &event, &terminate, &early, &reached);
    assert_false(event || terminate || early);
    assert_true(status != fmi3OK || fabs(reached - (t + h)) < 1e-12);
    return status;
}

fmi3Status update(fmi3Instance fmu, bool *again)
{
    bool terminate, nominals, states, has_next;
    double next;
    return UpdateDiscreteStates(fmu, again, &terminate, &nominals, &states, &has_next, &next);
}

void outputs(fmi3Instance fmu, int which, double *values)
{
    const int n = gearboxes[which].n_outputs;
    fmi3ValueReference references[MOST];
    assert_in_range(n, 1, MOST);
    for (int i = 0; i < n; i++) {
        references[i] = fmu_reference(FMU_OUTPUT, i);
    }
    assert_int_equal(GetFloat64(fmu, references, (size_t)n, values, (size_t)n), fmi3OK);
}

static const double H = 1.03e-4;

void steps(fmi3Instance fmu, int from, int to)
{
    for (int k = from; k < to; k++) {
        assert_int_equal(step(fmu, k * H, H), fmi3OK);
    }
}

fmi3Instance in_mode(int mode)
{
    fmi3Instance fmu = make(RATTLE, mode == STEP);
    bool again = true;
    switch (mode) {
    case CONFIGURATION:
        assert_int_equal(EnterConfigurationMode(fmu), fmi3OK);
        break;
    case INITIALIZATION:
        assert_int_equal(EnterInitializationMode(fmu, false, 0, 0, true, 1), fmi3OK);
        break;
    case EVENT:
    case STEP:
    case TERMINATED:
    case CONTINUOUS:
        begin(fmu);
        if (mode == TERMINATED) {
            assert_int_equal(Terminate(fmu), fmi3OK);
        } else if (mode == CONTINUOUS) {
            assert_int_equal(update(fmu, &again), fmi3OK);
            assert_int_equal(EnterContinuousTimeMode(fmu), fmi3OK);
        }
        break;
    default:
        break;
    }
    return fmu;
}

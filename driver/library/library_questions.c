/* Other queries of the library about a case. */
#include "analyses/datasheet.h"
#include "analyses/find_mesh.h"
#include "analyses/modes_find.h"
#include "analyses/show_json.h"
#include "analyses/static_analysis.h"
#include "base/memory.h"
#include "library/boundary.h"
#include "library/library.h"
#include "simulate/case_start.h"

#include <stdlib.h>

/* ---- texts ---- */

typedef struct {
    const case_plan *plan;
    const modes_request *modes;
    const char *mesh; /**< of the data sheet */
    bool is_html;
    bool (*write)(const void *question, FILE *stream, evl_error *error);
    char *text;
    evl_error error;
} question;

static void write_text(void *with)
{
    question *q = with;
    size_t length = 0;
    FILE *stream = memory_open(&q->text, &length);
    const bool good = q->write(q, stream, &q->error);
    memory_close(stream, &q->text);
    if (!good) {
        free(q->text);
        q->text = NULL;
    }
}

static char *ask(question *q, evolvent_error *error)
{
    boundary_call(write_text, q, &q->error);
    return library_report_error(&q->error, error) == EVOLVENT_OK ? q->text : NULL;
}

static bool write_modes(const void *asked, FILE *stream, evl_error *error)
{
    const question *q = asked;
    modes_point point;
    modes_report report;
    const char *why = modes_check(q->modes);
    if (why != NULL) {
        return evl_error_set(error, EVL_EXIT_USAGE, "", "%s", why);
    }
    if (!modes_read(q->modes, &point, error)) {
        return false;
    }
    const bool good = modes_find(q->plan, q->modes, &point, &report, error);
    if (good) {
        modes_print_json(stream, &report);
    }
    modes_free(&report);
    return good;
}

static bool write_show(const void *asked, FILE *stream, evl_error *error)
{
    const question *q = asked;
    const bool good = case_plan_add_root_stress(q->plan, error) && case_start_check(q->plan, error);
    if (good) {
        show_json(stream, q->plan, error);
    }
    return good;
}

static bool write_datasheet(const void *asked, FILE *stream, evl_error *error)
{
    const question *q = asked;
    int mesh;
    const bool good =
        find_mesh(q->plan->description, q->mesh, &mesh, error) && case_plan_add_root_stress(q->plan, error);
    if (good) {
        datasheet sheet;
        datasheet_make(&sheet, q->plan, mesh);
        (q->is_html ? datasheet_write_section : datasheet_write_json)(stream, &sheet);
        datasheet_free(&sheet);
    }
    return good;
}

static bool write_parameters(const void *asked, FILE *stream, evl_error *error)
{
    const question *q = asked;
    (void)error;
    show_parameters_json(stream, q->plan->model);
    return true;
}

char *evolvent_modes(const evolvent_case *gearbox, const evolvent_modes_request *request, const volatile int *stop,
                     evolvent_error *error)
{
    modes_request modes = {.interrupt = stop != NULL ? stop : &library_never, .who = library_who};
    if (request != NULL) {
        modes.at = request->at;
        modes.mesh_position = request->mesh_position;
        modes.mean = request->mean != 0;
    }
    return ask(&(question){.plan = &gearbox->plan, .modes = &modes, .write = write_modes}, error);
}

char *evolvent_show(const evolvent_case *gearbox, evolvent_error *error)
{
    return ask(&(question){.plan = &gearbox->plan, .write = write_show}, error);
}

char *evolvent_parameters(const evolvent_case *gearbox, evolvent_error *error)
{
    return ask(&(question){.plan = &gearbox->plan, .write = write_parameters}, error);
}

char *evolvent_datasheet(const evolvent_case *gearbox, const char *mesh, int html, evolvent_error *error)
{
    return ask(&(question){.plan = &gearbox->plan, .mesh = mesh, .is_html = html != 0, .write = write_datasheet},
               error);
}

void evolvent_text_free(char *text)
{
    free(text);
}

/* ---- influence functions of the root stress ---- */

typedef struct {
    const case_plan *plan;
    int wheel, n;
    const int *flanks, *teeth;
    const double *rho;
    double *arcs, *stress;
    evl_error error;
} influence_call;

static void find_influence(void *with)
{
    influence_call *s = with;
    const description *description = s->plan->description;
    if (s->wheel < 0 || s->wheel >= description->n_wheels) {
        (void)evl_error_set(&s->error, EVL_EXIT_USAGE, "", "there is no wheel %d; the case has 0 to %d", s->wheel,
                            description->n_wheels - 1);
    } else if (case_plan_add_root_stress(s->plan, &s->error) &&
               !model_root_influence(s->plan->model, s->wheel, s->n, s->flanks, s->rho, s->teeth, s->arcs, s->stress)) {
        (void)evl_error_set(
            &s->error, EVL_EXIT_USAGE, "",
            "wheel '%s' has no finite elements, so it has no root stress; give it the key compliance: {}",
            description->wheels[s->wheel]);
    }
}

evolvent_code evolvent_root_influence(const evolvent_case *gearbox, int wheel, int n, const int *flanks,
                                      const double *rho, const int *teeth, double *arcs, double *stress,
                                      evolvent_error *error)
{
    influence_call s = {.plan = &gearbox->plan,
                        .wheel = wheel,
                        .n = n,
                        .flanks = flanks,
                        .teeth = teeth,
                        .rho = rho,
                        .arcs = arcs,
                        .stress = stress};
    boundary_call(find_influence, &s, &s.error);
    return library_report_error(&s.error, error);
}

/* ---- quasi-static analysis of a mesh ---- */

typedef struct {
    static_request request;
    static_analysis analysis;
    history *in_memory;
    evolvent_record *record;
    evl_error error;
} static_call;

static void analyse(void *with)
{
    static_call *s = with;
    int points;
    s->analysis.path = s->analysis.of_case->path;
    s->analysis.in_memory = &s->in_memory;
    (void)(static_check(&s->request, &points, &s->error) && case_plan_add_root_stress(s->analysis.of_case, &s->error) &&
           static_plan_case(&s->analysis, &s->request, points, &s->error) &&
           static_analyse(&s->analysis, &s->request, &s->error));
    static_analysis_free(&s->analysis);
    s->record = library_record(s->in_memory);
}

evolvent_code evolvent_static(const evolvent_case *gearbox, const evolvent_static_request *request,
                              const volatile int *stop, evolvent_record **record, evolvent_error *error)
{
    static_call s = {.request = {.interrupt = stop != NULL ? stop : &library_never, .who = library_who},
                     .analysis = {.of_case = &gearbox->plan}};
    if (request != NULL) {
        s.request.mesh = request->mesh;
        s.request.torque = request->torque;
        s.request.speed = request->speed;
        s.request.points = request->points;
    }
    boundary_call(analyse, &s, &s.error);
    *record = s.record;
    return library_report_error(&s.error, error);
}

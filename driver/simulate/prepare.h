/** Model of a case file; every refusal names its location in the file. */
#pragma once

#include "simulate/prepared_case.h"

#include <signal.h>

/** Read and check the case and create its model. @return false with the reason in `error`: `file` is NULL if it could
 *  not be read, `model` if it could not be created. Free the result in any case */
bool prepare_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error);
/** Same with a store of known wheel compliances. */
bool prepare_case_with(prepared_case *prepared, const char *path, int n_set, const char *const *set,
                       const evl_wheel_store *wheels, evl_error *error);
/** Same for the text of a case. @param name  name in error messages */
bool prepare_text(prepared_case *prepared, const char *name, const char *text, int n_set, const char *const *set,
                  evl_error *error);
/** Same from a base parsed before.
 *  @param[in,out] prepared  zeros, or the result of an earlier call with this base: becomes the new case
 *                           If its `needs_roots` is set, the model gets the outputs of the root stress
 *  @param wheels  known compliant wheels
 *  @return false with the reason in `error`; then `prepared` serves only for the next call. Free it in any case */
bool prepare_edited(prepared_case *prepared, const case_base *base, int n_set, const char *const *set,
                    const evl_wheel_store *wheels, evl_error *error);
/** Initial state of the case, the last step that can be refused. A signal to the process ends the search for a periodic
 *  start. @return false with the reason in `error`: EVL_EXIT_CASE; EVL_EXIT_INTEGRATION, EVL_EXIT_INTERRUPTED for a
 *  periodic start */
bool prepare_start(const prepared_case *prepared, dae_state *state, evl_error *error);
/** Same with a given interrupt flag, which ends the search when it is not 0. */
bool prepare_start_unless(const prepared_case *prepared, const volatile sig_atomic_t *interrupt, dae_state *state,
                          evl_error *error);
/** Add the root stress of wheels with finite elements to the model. @param wheels  as in model_create. @return false with
 *  the reason in `error` */
bool prepare_root_stress(const prepared_case *prepared, const evl_wheel_store *wheels, evl_error *error);
/** Whether the initial state exists, so that `evolvent run` would start. A periodic orbit is not searched for. @return
 *  false with the reason in `error` */
bool prepare_check_start(const prepared_case *prepared, evl_error *error);
/** Turn a refusal by the model into an error at a location in the case file. @return false */
bool prepare_refuse(const prepared_case *prepared, const model_message *refusal, evl_error *error);
/** All warnings: numbers outside the plausible ranges of their keys, with their locations, and warnings of the model,
 *  preceded by their subject as in a refusal. For a refused case without a model only the former. @param arena  owns all
 *  that is returned */
const char **prepare_warning_list(const prepared_case *prepared, memory_arena *arena, int *n);
/** The same in one new string, "" if there are none. */
char *prepare_warnings(const prepared_case *prepared, const char *separator);
/** Same without those of numbers in the file itself, which are common to all cases of a batch. */
char *prepare_own_warnings(const prepared_case *prepared, const char *separator);
void prepared_case_free(prepared_case *prepared);

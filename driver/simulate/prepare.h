/** From a case file to a model, with every refusal shown at its place in the file. */
#pragma once

#include "case/case.h"
#include "model/model.h"

#include <signal.h>

typedef struct {
    case_file *file;
    model *model;
} prepared_case;

/** Read and check the case and make its model. @return false with the reason in `error`: `file` is NULL if it could not be read,
 *  `model` if there is none. In any case it is to be freed */
bool prepare_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error);
/** The same with wheels whose compliance may be known. */
bool prepare_case_with(prepared_case *prepared, const char *path, int n_set, const char *const *set,
                       const evl_wheel_store *wheels, evl_error *error);
/** The same of the text of a case. @param name  what errors call it */
bool prepare_text(prepared_case *prepared, const char *name, const char *text, int n_set, const char *const *set,
                  evl_error *error);
/** The same from a base that was parsed before.
 *  @param[in,out] prepared  zeros, or what an earlier call with this base has made: it becomes the new case
 *  @param wheels  known ones that give way
 *  @return false with the reason in `error`; then it serves for the next call only. In any case it is to be freed */
bool prepare_edited(prepared_case *prepared, const case_base *base, int n_set, const char *const *set,
                    const evl_wheel_store *wheels, evl_error *error);
/** The state that the case starts from, the last thing that can be refused. A signal to the process ends the search for a periodic
 *  start. @return false with the reason in `error`: EVL_EXIT_CASE; EVL_EXIT_INTEGRATION, EVL_EXIT_INTERRUPTED of a periodic start */
bool prepare_start(const prepared_case *prepared, dae_state *state, evl_error *error);
/** The same with another word that ends the search when it is not 0. */
bool prepare_start_unless(const prepared_case *prepared, const volatile sig_atomic_t *interrupt, dae_state *state,
                          evl_error *error);
/** Whether there is such a state: then `evolvent run` would begin. A periodic orbit is not searched for. @return false with the reason
 *  in `error` */
bool prepare_check_start(const prepared_case *prepared, evl_error *error);
/** Turn a refusal by the model into one of the case file. @return false */
bool prepare_refuse(const prepared_case *prepared, const model_message *refusal, evl_error *error);
/** All warnings: of numbers outside the plausible ranges of their keys, with their locations, and of the model, with what each is
 *  about in front as in a refusal; of a refused case without a model the former. @param pool  of all that is returned */
const char **prepare_warning_list(const prepared_case *prepared, memory_pool *pool, int *n);
/** The same in one new string, "" if there are none. */
char *prepare_warnings(const prepared_case *prepared, const char *separator);
/** The same, less those of numbers of the file itself, which all cases of a batch share. */
char *prepare_own_warnings(const prepared_case *prepared, const char *separator);
void prepared_case_free(prepared_case *prepared);

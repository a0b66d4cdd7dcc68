/** From a case file to a model, with every refusal shown at its place in the file. */
#ifndef EVOLVENT_PREPARE_H
#define EVOLVENT_PREPARE_H

#include "case.h"
#include "model.h"

typedef struct {
    case_file *file;
    model *model;
} prepared_case;

/** Read and check the case and make its model. @return false with the reason in `error`; then there is nothing to free */
bool prepare_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error);
/** The same from a base that was parsed before.
 *  @param[in,out] prepared  zeros, or what an earlier call with this base has made: it becomes the new case
 *  @return false with the reason in `error`; then it serves for the next call only. In any case it is to be freed */
bool prepare_edited(prepared_case *prepared, const case_base *base, int n_set, const char *const *set,
                    evl_error *error);
/** Turn a refusal by the model into one of the case file. */
void prepare_refuse(const prepared_case *prepared, const model_error *refusal, evl_error *error);
void prepared_case_free(prepared_case *prepared);

#endif

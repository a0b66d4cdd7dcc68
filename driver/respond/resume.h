/** Checkpoint of a response, so that the same command resumes it: in the folder NAME.parts of its result NAME. The
 *  caller defines the content. */
#pragma once

#include "files/checkpoint.h"
#include "files/parts.h"

typedef struct {
    parts parts;   /**< a locked folder with the checkpoint */
    checkpoint of; /**< identification of the computation */
    void *self;
    void (*serialize)(void *self, archive *archive); /**< writes or reads the state */
    double saved, took;                              /**< clock of the last checkpoint; time that it took [s] */
} resume;

/** Set the identification of the state: it must be the same when it is resumed. */
void resume_identify(resume *resume, const char *text);
/** Lock the folder. @return false with the reason in `error` */
bool resume_open(resume *resume, const char *path, evl_error *error);
/** Read the checkpoint of an earlier run. @param found  whether there is one. @return false with the reason in `error`:
 *  it belongs to another computation */
bool resume_read(resume *resume, bool *found, evl_error *error);
/** Whether a checkpoint is due: at most four times a second, and a tenth of the total time. */
bool resume_is_due(const resume *resume);
/** Write a checkpoint. @param t  amount of work done */
bool resume_save(resume *resume, double t, evl_error *error);
/** Release the folder; if all is `done`, delete it. */
void resume_close(resume *resume, bool done);

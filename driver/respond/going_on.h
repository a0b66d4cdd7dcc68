/** How far a response has come, on file, so that the same command goes on from there: a checkpoint in the folder NAME.parts of its
 *  result NAME. What is kept is the caller's. */
#pragma once

#include "files/checkpoint.h"
#include "files/parts.h"

typedef struct {
    parts parts;   /**< a folder, locked, with what is needed to go on */
    checkpoint of; /**< what that is of */
    void *self;
    void (*keep)(void *self, archive *archive); /**< writes it, or reads it */
    double saved, took;                         /**< clock when it was kept last; how long that took [s] */
} going_on;

/** Say what the kept state is of: it fits what is the same in all of it. */
void going_on_identify(going_on *going_on, const char *text);
/** Lock the folder. @return false with the reason in `error` */
bool going_on_open(going_on *going_on, const char *path, evl_error *error);
/** Read what an earlier run left. @param found  whether one did @return false with the reason in `error`: it is of something else */
bool going_on_take_up(going_on *going_on, bool *found, evl_error *error);
/** Whether it is time to keep it: four times a second, and a tenth of all time at most. */
bool going_on_is_due(const going_on *going_on);
/** Keep it. @param t  how much is done */
bool going_on_save(going_on *going_on, double t, evl_error *error);
/** Let go of the folder; if all is `done`, it goes. */
void going_on_close(going_on *going_on, bool done);

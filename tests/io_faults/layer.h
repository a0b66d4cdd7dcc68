/** What the layers between a program and the system share. They are preloaded by tests (LD_PRELOAD) and installed nowhere. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

/** Whether main has begun: what loaders and libraries do before is nobody's business here. */
extern bool layer_is_armed;
/** Is called when main begins. */
void layer_begin(void);

/** Value of a variable of the environment, NULL if it is empty or not there. */
const char *layer_setting(const char *name);
/** The function of the C library that a layer stands before. @param function  a pointer to a pointer to such a function */
void layer_next(const char *name, void *function);

/** Whether a path lies in the folder of the test; a relative one counts from `folder`, a descriptor or AT_FDCWD. */
bool layer_owns_path(int folder, const char *path);
/** Whether a descriptor is of a file or folder in the folder of the test. */
bool layer_owns(int descriptor);
/** Whether it is a socket, through which workers talk to their parent. */
bool layer_is_socket(int descriptor);

/** A stream whose reads and writes go through the layer's read, write and close: those of the C library call the system past it. */
FILE *layer_stream(int descriptor, const char *mode);
/** Make standard output and error such streams; Python, which writes to the descriptors, wants them as they are. */
void layer_take_streams(void);

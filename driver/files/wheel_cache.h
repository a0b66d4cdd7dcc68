/** Cache of computed wheel compliances for the user's next runs: one file per wheel in the user's cache folder.
 *
 *  The folder is $EVOLVENT_CACHE, else $XDG_CACHE_HOME/evolvent, else $HOME/.cache/evolvent; EVOLVENT_CACHE=off: none.
 *  Data that cannot be read or written are computed. Any number of processes may use it at once. Its size is at most 64
 *  MB; the least recently used files are deleted first. A file is valid only for the program whose sources computed it,
 *  so results are bitwise those without a cache. */
#pragma once

#include <evolvent/description.h>

typedef struct wheel_cache wheel_cache;

wheel_cache *wheel_cache_open(void);
void wheel_cache_close(wheel_cache **cache);
/** Argument for model_create. */
const evl_wheel_store *wheel_cache_store(const wheel_cache *cache);

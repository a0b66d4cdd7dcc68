/** The identity of a design: a hash over all that decides its results. docs/batch.md describes what goes into it, and
 *  postprocess/evolvent/sweep/design.py finds the same. A leaf. */
#pragma once

#include "base/sha256.h"
#include "files/design.h"

/** @param maker  what another program than evolvent-sweep named the design by; "" if there is nothing of the kind */
void design_hash(const design *design, const char *maker, char text[SHA256_TEXT]);

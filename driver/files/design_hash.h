/** Identity of a design: a hash of everything that affects its results. docs/guides/batch.md describes its input;
 *  postprocess/evolvent/sweep/design.py computes the same hash. Leaf module. */
#pragma once

#include "base/sha256.h"
#include "files/design.h"

/** @param maker  name of the design given by another program than evolvent-sweep; "" if there is none */
void design_hash(const design *design, const char *maker, char text[SHA256_TEXT]);

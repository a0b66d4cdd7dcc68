/** A record of one located event: what happened, and the state on both sides of it. */
#pragma once

#include "integrate/dae.h"

typedef struct {
    double t;
    dae_event what;
    int n;                           /**< length of the states */
    const dae_state *before, *after; /**< valid during the call only */
} event_record;

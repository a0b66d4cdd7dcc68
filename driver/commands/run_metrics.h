/** Summary of the metrics of a case at the end of a run. */
#pragma once

#include "simulate/metric_channel.h"
#include "simulate/metrics.h"

/** Print one line per mesh, or the reason why there are no metrics. */
void report_metrics(const metrics *metrics, const model_names *names);

/** Parts of a JSON Schema: what a value of a row may be. Keywords go into the object that is open. */
#pragma once

#include "base/json.h"
#include "case/case_schema.h"

/** A value of this row. */
void json_schema_value(json_writer *json, const evl_row *row);
/** What a definition says, in an object of its own if there is a key. */
void json_schema_reference(json_writer *json, const char *key, const char *definition);
/** The definition of numbers with this unit: a number, or text that is a number with one of the unit's kind. */
void json_schema_quantity(json_writer *json, const char *key_unit);

/** Parts of a JSON Schema: permitted values of a row. Keywords are written into the open object. */
#pragma once

#include "base/json.h"
#include "case/case_schema.h"

/** The value of this row. */
void json_schema_value(json_writer *json, const evl_row *row);
/** Reference to a definition, in an object of its own if there is a key. */
void json_schema_reference(json_writer *json, const char *key, const char *definition);
/** Definition of numbers with this unit: a number, or text with a number and a unit of the same kind. */
void json_schema_quantity(json_writer *json, const char *key_unit);

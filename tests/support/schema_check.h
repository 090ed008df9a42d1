// Checks a document against a JSON Schema, for the keywords that jobs/schema.json uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>

// `root` is the schema's own document, the same for all of a program: a "$ref" names one of its "$defs". Ends the
// program at a keyword that it does not know, so that no rule is passed over. Patterns are read as POSIX extended
// expressions.
bool schema_accepts(const struct json_node *root, const struct json_node *document);

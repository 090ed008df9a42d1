// What `marchd --help` prints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern const char options_help[];

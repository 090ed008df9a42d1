// The text of march-web --help.
// SPDX-License-Identifier: Apache-2.0
#pragma once
extern const char web_help[];

// Time that only goes forward, for durations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

double clock_now_s(void); // since some moment before the program started

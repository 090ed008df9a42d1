// The words for what an audit compared with, in files and messages.
#pragma once

#include "worker/audit.h"

const char *audit_name(enum audit_kind kind);      // NULL of AUDIT_NONE
enum audit_kind audit_name_find(const char *name); // AUDIT_NONE where no audit has that name

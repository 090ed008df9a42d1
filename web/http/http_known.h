// Whose the tokens are that the farm has taken lately, so that a request's user is known before the farm is asked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Nobody gets rights by it: it decides whose share of march-web a request uses.
struct http_known;

struct http_known *http_known_create(void);
void http_known_destroy(struct http_known *known); // accepts NULL
// Texts are copied; of tokens only 64 bits of a hash with a secret are kept. Of more than 1024 tokens the one that was
// not asked for longest is forgotten.
void http_known_add(struct http_known *known, const char *token, const char *user);
void http_known_drop(struct http_known *known, const char *token);
// NULL: it is not known, or `token` is NULL. Borrowed until the next call.
const char *http_known_user(struct http_known *known, const char *token);

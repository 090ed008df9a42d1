// The page and the other files that everybody gets: no token is needed, for they hold nothing of the farm.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct http_request;

// Where they are. Borrowed.
struct route_files {
    const char *page_folder, *document_folder, *chart_file;
};

// Each is a route's answer; `user` is a struct route_files.
void route_files_front(struct http_request *request, void *user); // index.html
void route_files_page(struct http_request *request, void *user);  // /page/NAME
void route_files_chart(struct http_request *request, void *user);
void route_files_document(struct http_request *request, void *user); // /NAME.json

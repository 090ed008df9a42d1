// Requests of clients: finds the method, checks the names of its parameters, answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/request.h"

struct client;
struct farm;
struct message;

void requests_handle(struct farm *farm, struct client *client, struct message *message);

extern const char *const job_list_orders[]; // of job.list; end in NULL

enum { PLANS_DEFAULT = 100, PLANS_LIMIT = 1000 }; // of job.plans

// The methods of docs/protocol.md.
enum request_outcome requests_daemon_status(struct request *request);
enum request_outcome requests_daemon_metrics(struct request *request);
enum request_outcome requests_daemon_drain(struct request *request);
enum request_outcome requests_daemon_undrain(struct request *request);
enum request_outcome requests_daemon_reload(struct request *request);
enum request_outcome requests_auth_token(struct request *request);
enum request_outcome requests_auth_drop(struct request *request);
enum request_outcome requests_token_create(struct request *request);
enum request_outcome requests_token_list(struct request *request);
enum request_outcome requests_token_revoke(struct request *request);
enum request_outcome requests_worker_list(struct request *request);
enum request_outcome requests_events_subscribe(struct request *request);
enum request_outcome requests_events_unsubscribe(struct request *request);
enum request_outcome requests_job_list(struct request *request);
enum request_outcome requests_job_show(struct request *request);
enum request_outcome requests_job_frames(struct request *request);
enum request_outcome requests_job_frame_map(struct request *request);
enum request_outcome requests_job_plans(struct request *request);
enum request_outcome requests_job_log(struct request *request);
enum request_outcome requests_job_submit(struct request *request);
enum request_outcome requests_job_pause(struct request *request);
enum request_outcome requests_job_resume(struct request *request);
enum request_outcome requests_job_cancel(struct request *request);
enum request_outcome requests_job_priority(struct request *request);
enum request_outcome requests_job_retry(struct request *request);
enum request_outcome requests_job_delete(struct request *request);
enum request_outcome requests_notify_pending(struct request *request);
enum request_outcome requests_notify_done(struct request *request);

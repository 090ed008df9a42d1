#!/bin/bash
# A short campaign: everything breaks at random moments, and what is on disk is audited from outside (docs/reliability.md).
#   CAMPAIGN_ACTS=400 CAMPAIGN_SEED=7 tests/process/daemon_campaign_test.sh   longer, with other choices
set -eu
python3 "$PROJECT_ROOT/tests/campaign_parts/audit_test.py" 2>&1 # the audit notices what it is there to notice
"$PROJECT_ROOT/tests/campaign" --acts "${CAMPAIGN_ACTS:-80}" --seed "${CAMPAIGN_SEED:-1}" # not minutes: as much happens on a busy machine

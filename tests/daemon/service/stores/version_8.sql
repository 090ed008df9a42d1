-- What a daemon of schema version 8 had written when it was killed, with fewer frames. For restore_test.c.
PRAGMA journal_mode = WAL;
PRAGMA application_id = 1299342184;
PRAGMA user_version = 8;
CREATE TABLE daemon (epoch INTEGER NOT NULL, last_job_id INTEGER NOT NULL DEFAULT 0, farm TEXT);
INSERT INTO daemon VALUES(1,6,'94dd60d5a17452ae50f3219f8c7a312e');
CREATE TABLE job (
    id INTEGER PRIMARY KEY, name TEXT, owner TEXT, owner_uid INTEGER NOT NULL, priority INTEGER NOT NULL,
    is_paused INTEGER NOT NULL, is_canceled INTEGER NOT NULL, is_failed INTEGER NOT NULL,
    submitted_ms INTEGER NOT NULL, started_ms INTEGER NOT NULL, finished_ms INTEGER NOT NULL,
    reason TEXT, root TEXT);
INSERT INTO job VALUES(1,'castle','root',0,50,0,0,0,1795425327973,1795425328013,1795425328769,NULL,'/films');
INSERT INTO job VALUES(2,'broken','root',0,50,0,0,1,1795425328790,1795425328836,1795425328850,'shader: x.glsl:1: error: `nothing'' undeclared','/films');
INSERT INTO job VALUES(3,'Höhle','root',0,50,1,1,0,1795425328870,0,1795425328876,'canceled by root','/films');
INSERT INTO job VALUES(4,'held','root',0,70,1,0,0,1795425328899,0,0,'paused by root','/films');
INSERT INTO job VALUES(5,'half','root',0,50,0,0,0,1795425328919,1795425328977,0,NULL,'/films');
CREATE TABLE document (job INTEGER PRIMARY KEY, text TEXT NOT NULL);
INSERT INTO document VALUES(1,'{"version":1,"name":"castle","frames":"1-3","fps":24,"resolution":[32,18],"camera":{"position":[0,0,4],"target":[0,0,0],"fov":30},"lights":[{"kind":"point","position":[2,2,2],"intensity":40}],"scene":{"media":[{"density":{"kind":"noise","frequency":1,"bounds":{"kind":"sphere","center":[0,0,0],"radius":1}},"sigma_a":1,"sigma_s":2}]},"output":{"path":"castle/f.####.exr"},"quality":{"tolerance":0.05}}');
INSERT INTO document VALUES(2,'{"version":1,"name":"broken","frames":"1-2","fps":24,"resolution":[32,18],"camera":{"position":[0,0,4],"target":[0,0,0],"fov":30},"lights":[{"kind":"point","position":[2,2,2],"intensity":40}],"scene":{"media":[{"density":{"kind":"glsl","file":"/x.glsl","source":"float density(vec3 p, float t) { return nothing; }","lipschitz":1,"bounds":{"kind":"sphere","center":[0,0,0],"radius":1}},"sigma_a":1,"sigma_s":2}]},"output":{"path":"broken/f.####.exr"},"quality":{"method":"midpoint","step":0.1,"light_step":0.2}}');
INSERT INTO document VALUES(3,'{"version":1,"name":"Höhle","frames":"1-5","fps":24,"resolution":[32,18],"camera":{"position":[0,0,4],"target":[0,0,0],"fov":30},"lights":[{"kind":"point","position":[2,2,2],"intensity":40}],"scene":{"media":[{"density":{"kind":"noise","frequency":1,"bounds":{"kind":"sphere","center":[0,0,0],"radius":1}},"sigma_a":1,"sigma_s":2}]},"output":{"path":"Höhle/f.####.exr"},"quality":{"method":"midpoint","step":0.1,"light_step":0.2}}');
INSERT INTO document VALUES(4,'{"version":1,"name":"held","frames":"1-4","fps":24,"resolution":[32,18],"camera":{"position":[0,0,4],"target":[0,0,0],"fov":30},"lights":[{"kind":"point","position":[2,2,2],"intensity":40}],"scene":{"media":[{"density":{"kind":"noise","frequency":1,"bounds":{"kind":"sphere","center":[0,0,0],"radius":1}},"sigma_a":1,"sigma_s":2}]},"output":{"path":"held/f.####.exr"},"quality":{"method":"jittered","step":0.1,"light_step":0.2},"priority":70}');
INSERT INTO document VALUES(5,'{"version":1,"name":"half","frames":"1-40x2,100","fps":24,"resolution":[640,360],"camera":{"position":[0,0,4],"target":[0,0,0],"fov":30},"lights":[{"kind":"point","position":[2,2,2],"intensity":40}],"scene":{"media":[{"density":{"kind":"noise","frequency":1,"bounds":{"kind":"sphere","center":[0,0,0],"radius":1}},"sigma_a":1,"sigma_s":2}]},"output":{"path":"half/f.####.exr"},"quality":{"method":"midpoint","step":0.02,"light_step":0.1}}');
CREATE TABLE frame (
    job INTEGER NOT NULL, frame_index INTEGER NOT NULL, state INTEGER NOT NULL,
    attempts INTEGER NOT NULL DEFAULT 0, epoch INTEGER NOT NULL DEFAULT 0, inode INTEGER NOT NULL DEFAULT 0,
    size_bytes INTEGER NOT NULL DEFAULT 0, hash TEXT, render_s REAL NOT NULL DEFAULT 0,
    encode_s REAL NOT NULL DEFAULT 0, error TEXT, audit TEXT, measured_error REAL, error95 REAL, audit_rays INTEGER, method TEXT, cut_share REAL, plan INTEGER, traced REAL, audit_s REAL, PRIMARY KEY (job, frame_index)) WITHOUT ROWID;
INSERT INTO frame VALUES(1,0,2,1,1,1130562,2913,'daeaf0a014f2ce14366526009feb6b61',0.00065425300272181630134,0.004555341001832857728,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL,0.00070847400638740509748);
INSERT INTO frame VALUES(1,1,2,1,1,1130564,2913,'7099408df703fe00c3f198e16b8ad8c4',0.00060438900254666805267,0.0022030870022717863321,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL,0.0029329879907891154289);
INSERT INTO frame VALUES(1,2,2,1,1,1130563,2913,'18d25a995ab372ff2b6175984e90d0f8',0.00011366899707354605197,0.00072460799128748476505,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL,0.0);
INSERT INTO frame VALUES(2,1,3,1,1,0,0,NULL,0.0,0.0,'shader: x.glsl:1: error: `nothing'' undeclared',NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,0.0);
INSERT INTO frame VALUES(5,0,2,1,1,1130581,126930,'0f69cc10356a18c9b44ba253afe2bce0',0.92040304499096237123,0.0036816269857808947563,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,0.0);
INSERT INTO frame VALUES(5,1,2,1,1,1130569,126930,'098d21089e1aa1c1e5d97a12e68c730d',0.81918842600134667009,0.0051163909956812858581,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,0.0);
INSERT INTO frame VALUES(5,2,2,1,1,1130570,126930,'6cfa863f32b4b5be5070639c28d23235',0.0010212389897787943482,0.003745651993085630238,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,0.0);
CREATE TABLE attempt (
    job INTEGER NOT NULL, number INTEGER NOT NULL, frame INTEGER NOT NULL, attempt INTEGER NOT NULL,
    worker INTEGER NOT NULL, ended_ms INTEGER NOT NULL, outcome TEXT NOT NULL, log TEXT,
    PRIMARY KEY (job, number)) WITHOUT ROWID;
INSERT INTO attempt VALUES(2,1,2,1,2,1795425328850,'failed','shader: x.glsl:1: error: `nothing'' undeclared');
CREATE TABLE plan (
    number INTEGER PRIMARY KEY, owner_uid INTEGER NOT NULL, scene TEXT NOT NULL, segment TEXT NOT NULL,
    text TEXT NOT NULL);
INSERT INTO plan VALUES(1,0,'9e405e8f28b7dcc20cae39d3b51df23d','8af6ac5fd10e1d285595b7f3e3fb7b91','{"quality":{"method":"midpoint"}}');
CREATE TABLE root (path TEXT PRIMARY KEY, id TEXT NOT NULL) WITHOUT ROWID;
INSERT INTO root VALUES('/films','9ac7d69db5a7b71c2b991040114b88d0');
CREATE TABLE usage (owner_uid INTEGER PRIMARY KEY, used_s REAL NOT NULL, at_ms INTEGER NOT NULL);
INSERT INTO usage VALUES(0,12.5,1795425330621);
CREATE INDEX plan_of_owner ON plan (owner_uid);
CREATE INDEX plan_of_segment ON plan (owner_uid, scene, segment);

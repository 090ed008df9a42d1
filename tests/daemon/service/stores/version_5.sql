-- What a daemon of schema version 5 had written when it was killed, with fewer frames. For restore_test.c.
PRAGMA journal_mode = WAL;
PRAGMA application_id = 1299342184;
PRAGMA user_version = 5;
CREATE TABLE daemon (epoch INTEGER NOT NULL, last_job_id INTEGER NOT NULL DEFAULT 0);
INSERT INTO daemon VALUES(1,6);
CREATE TABLE job (
    id INTEGER PRIMARY KEY, name TEXT, owner TEXT, owner_uid INTEGER NOT NULL, priority INTEGER NOT NULL,
    is_paused INTEGER NOT NULL, is_canceled INTEGER NOT NULL, is_failed INTEGER NOT NULL,
    submitted_ms INTEGER NOT NULL, started_ms INTEGER NOT NULL, finished_ms INTEGER NOT NULL,
    reason TEXT, root TEXT);
INSERT INTO job VALUES(1,'castle','root',0,50,0,0,0,1795425286777,1795425286857,1795425288789,NULL,'/films');
INSERT INTO job VALUES(2,'broken','root',0,50,0,0,1,1795425288838,1795425288937,1795425288979,'shader: x.glsl:1: error: `nothing'' undeclared','/films');
INSERT INTO job VALUES(3,'Höhle','root',0,50,1,1,0,1795425289024,0,1795425289055,'canceled by root','/films');
INSERT INTO job VALUES(4,'held','root',0,70,1,0,0,1795425289096,0,0,'paused by root','/films');
INSERT INTO job VALUES(5,'half','root',0,50,0,0,0,1795425289149,1795425289253,0,NULL,'/films');
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
    encode_s REAL NOT NULL DEFAULT 0, error TEXT, audit TEXT, measured_error REAL, error95 REAL, audit_rays INTEGER, method TEXT, cut_share REAL, plan INTEGER, traced REAL, PRIMARY KEY (job, frame_index)) WITHOUT ROWID;
INSERT INTO frame VALUES(1,0,2,1,1,1130503,2859,'aca6dce22ab4178e82c01da859f32b16',0.0027854939980898052453,0.0022144239919725805521,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL);
INSERT INTO frame VALUES(1,1,2,1,1,1130505,2859,'c89fab05df826a35c958b11f9c9527c5',0.0019082479993812739849,0.002768938997178338468,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL);
INSERT INTO frame VALUES(1,2,2,1,1,1130504,2859,'a6c361a9b62d4303309120c845715e37',0.00012500600132625550031,0.011098019997007213532,NULL,'reference',0.0072382701054035493773,0.011384500467277300708,112,'midpoint',NULL,1,NULL);
INSERT INTO frame VALUES(2,0,3,1,1,0,0,NULL,0.0,0.0,'shader: x.glsl:1: error: `nothing'' undeclared',NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
INSERT INTO frame VALUES(5,0,2,1,1,1130524,126878,'82913be5cdf7f608e83f5b2c4f13bc69',2.4547340559947770088,0.012917305997689254581,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
INSERT INTO frame VALUES(5,1,2,1,1,1130510,126878,'0f78727915c740d6e7845f65f4bc891f',1.4016117239953018724,0.018904733005911111831,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
INSERT INTO frame VALUES(5,2,2,1,1,1130511,126878,'5fe141e52c2d48fa821f0ec565b88922',0.0010256059904349967837,0.020336523011792451143,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
INSERT INTO frame VALUES(5,9,1,2,1,1130525,126878,'7e73c8eb53e0ba95775607fbfe0eb450',0.00058825500309467315673,0.012740793987177312374,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
CREATE TABLE attempt (
    job INTEGER NOT NULL, number INTEGER NOT NULL, frame INTEGER NOT NULL, attempt INTEGER NOT NULL,
    worker INTEGER NOT NULL, ended_ms INTEGER NOT NULL, outcome TEXT NOT NULL, log TEXT,
    PRIMARY KEY (job, number)) WITHOUT ROWID;
INSERT INTO attempt VALUES(2,1,1,1,1,1795425288979,'failed','shader: x.glsl:1: error: `nothing'' undeclared');
CREATE TABLE plan (
    number INTEGER PRIMARY KEY, owner_uid INTEGER NOT NULL, scene TEXT NOT NULL, segment TEXT NOT NULL,
    text TEXT NOT NULL);
INSERT INTO plan VALUES(1,0,'9e405e8f28b7dcc20cae39d3b51df23d','b158357179981394fa2c1f8ef11ae006','{"quality":{"method":"midpoint"}}');
CREATE INDEX plan_of_owner ON plan (owner_uid);
CREATE INDEX plan_of_segment ON plan (owner_uid, scene, segment);

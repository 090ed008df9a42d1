// How a picture that was asked for ends: as the status of an HTTP answer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum picture_status {
    PICTURE_READY = 200,
    PICTURE_KNOWN = 304,      // the asker has it
    PICTURE_WRONG = 400,      // the picture has no such channel or part
    PICTURE_FORBIDDEN = 403,  // march-web may not read the file
    PICTURE_ABSENT = 404,     // there is no file
    PICTURE_UNREADABLE = 422, // there is one that is no picture
    PICTURE_FAULT = 500,      // the worker failed, at this file or at all
    PICTURE_BUSY = 503,       // too many are asked for
    PICTURE_SLOW = 504,       // it took too long
    PICTURE_NO_ROOM = 507     // the cache cannot be written
};

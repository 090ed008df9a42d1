// The GL functions this program calls, found by name in a context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GL/glcorearb.h>
#include <stdbool.h>

struct error;
struct gl_context;

#define GL_FUNCTIONS(X)                                                                                                \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                                             \
    X(PFNGLBEGINQUERYPROC, BeginQuery)                                                                                 \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase)                                                                         \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                                       \
    X(PFNGLBINDIMAGETEXTUREPROC, BindImageTexture)                                                                     \
    X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit)                                                                       \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                                       \
    X(PFNGLBLENDFUNCPROC, BlendFunc)                                                                                   \
    X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus)                                               \
    X(PFNGLCLEARNAMEDBUFFERDATAPROC, ClearNamedBufferData)                                                             \
    X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv)                                                       \
    X(PFNGLCLEARTEXIMAGEPROC, ClearTexImage)                                                                           \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                                           \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                                                                           \
    X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                                                                 \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                                           \
    X(PFNGLCREATEQUERIESPROC, CreateQueries)                                                                           \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                                             \
    X(PFNGLCREATETEXTURESPROC, CreateTextures)                                                                         \
    X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                                                                 \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback)                                                             \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                                                           \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                                                 \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                                           \
    X(PFNGLDELETEQUERIESPROC, DeleteQueries)                                                                           \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                                             \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                                         \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                                                                 \
    X(PFNGLDISABLEPROC, Disable)                                                                                       \
    X(PFNGLDISPATCHCOMPUTEPROC, DispatchCompute)                                                                       \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                                                                                 \
    X(PFNGLENABLEPROC, Enable)                                                                                         \
    X(PFNGLENDQUERYPROC, EndQuery)                                                                                     \
    X(PFNGLFINISHPROC, Finish)                                                                                         \
    X(PFNGLGETERRORPROC, GetError)                                                                                     \
    X(PFNGLGETGRAPHICSRESETSTATUSPROC, GetGraphicsResetStatus)                                                         \
    X(PFNGLGETFLOATVPROC, GetFloatv)                                                                                   \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                                                                               \
    X(PFNGLGETNAMEDBUFFERSUBDATAPROC, GetNamedBufferSubData)                                                           \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                                                                   \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                                             \
    X(PFNGLGETQUERYOBJECTUI64VPROC, GetQueryObjectui64v)                                                               \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                                                     \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                                                                               \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                                                                 \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                                               \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)                                                                           \
    X(PFNGLNAMEDBUFFERDATAPROC, NamedBufferData)                                                                       \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                                                                 \
    X(PFNGLNAMEDFRAMEBUFFERDRAWBUFFERSPROC, NamedFramebufferDrawBuffers)                                               \
    X(PFNGLNAMEDFRAMEBUFFERREADBUFFERPROC, NamedFramebufferReadBuffer)                                                 \
    X(PFNGLNAMEDFRAMEBUFFERTEXTUREPROC, NamedFramebufferTexture)                                                       \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                                               \
    X(PFNGLPROGRAMUNIFORM1IPROC, ProgramUniform1i)                                                                     \
    X(PFNGLPROGRAMUNIFORM3IPROC, ProgramUniform3i)                                                                     \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                                                 \
    X(PFNGLSCISSORPROC, Scissor)                                                                                       \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                                             \
    X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                                                                   \
    X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D)                                                                     \
    X(PFNGLTEXTURESTORAGE3DPROC, TextureStorage3D)                                                                     \
    X(PFNGLTEXTURESUBIMAGE2DPROC, TextureSubImage2D)                                                                   \
    X(PFNGLTEXTURESUBIMAGE3DPROC, TextureSubImage3D)                                                                   \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                                                 \
    X(PFNGLVIEWPORTPROC, Viewport)

struct gl_functions {
#define GL_FUNCTION_MEMBER(type, name) type name;
    GL_FUNCTIONS(GL_FUNCTION_MEMBER)
#undef GL_FUNCTION_MEMBER
};

// On failure `error` names the first function that GL lacks.
bool gl_functions_load(struct gl_functions *gl, const struct gl_context *context, struct error *error);

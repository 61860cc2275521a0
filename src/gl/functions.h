#pragma once
// The OpenGL entry points that the project calls. Each context loads them by its own getProcAddress: contexts
// of EGL, OSMesa and a caller may exist in one process, and their pointers differ.

#include <GL/glcorearb.h>

#include <string_view>

namespace binosplat::gl {

// X(name without gl, name in upper case as in the pointer type PFNGL...PROC)
#define BINOSPLAT_GL_FUNCTIONS(X)                                                       \
  X(ActiveTexture, ACTIVETEXTURE)                                                       \
  X(AttachShader, ATTACHSHADER)                                                         \
  X(BindBuffer, BINDBUFFER)                                                             \
  X(BindBufferBase, BINDBUFFERBASE)                                                     \
  X(BindBufferRange, BINDBUFFERRANGE)                                                   \
  X(BindFramebuffer, BINDFRAMEBUFFER)                                                   \
  X(BindImageTexture, BINDIMAGETEXTURE)                                                 \
  X(BindSampler, BINDSAMPLER)                                                           \
  X(BindTexture, BINDTEXTURE)                                                           \
  X(BindTextureUnit, BINDTEXTUREUNIT)                                                   \
  X(BindVertexArray, BINDVERTEXARRAY)                                                   \
  X(BlitNamedFramebuffer, BLITNAMEDFRAMEBUFFER)                                         \
  X(CheckNamedFramebufferStatus, CHECKNAMEDFRAMEBUFFERSTATUS)                           \
  X(Clear, CLEAR)                                                                       \
  X(ClearColor, CLEARCOLOR)                                                             \
  X(ClearNamedBufferData, CLEARNAMEDBUFFERDATA)                                         \
  X(ClientWaitSync, CLIENTWAITSYNC)                                                     \
  X(ClipControl, CLIPCONTROL)                                                           \
  X(CompileShader, COMPILESHADER)                                                       \
  X(CopyNamedBufferSubData, COPYNAMEDBUFFERSUBDATA)                                     \
  X(CreateBuffers, CREATEBUFFERS)                                                       \
  X(CreateFramebuffers, CREATEFRAMEBUFFERS)                                             \
  X(CreateProgram, CREATEPROGRAM)                                                       \
  X(CreateQueries, CREATEQUERIES)                                                       \
  X(CreateSamplers, CREATESAMPLERS)                                                     \
  X(CreateShader, CREATESHADER)                                                         \
  X(CreateTextures, CREATETEXTURES)                                                     \
  X(CreateVertexArrays, CREATEVERTEXARRAYS)                                             \
  X(DebugMessageCallback, DEBUGMESSAGECALLBACK)                                         \
  X(DeleteBuffers, DELETEBUFFERS)                                                       \
  X(DeleteFramebuffers, DELETEFRAMEBUFFERS)                                             \
  X(DeleteProgram, DELETEPROGRAM)                                                       \
  X(DeleteQueries, DELETEQUERIES)                                                       \
  X(DeleteSamplers, DELETESAMPLERS)                                                     \
  X(DeleteShader, DELETESHADER)                                                         \
  X(DeleteSync, DELETESYNC)                                                             \
  X(DeleteTextures, DELETETEXTURES)                                                     \
  X(DeleteVertexArrays, DELETEVERTEXARRAYS)                                             \
  X(DepthFunc, DEPTHFUNC)                                                               \
  X(DepthMask, DEPTHMASK)                                                               \
  X(Disable, DISABLE)                                                                   \
  X(Disablei, DISABLEI)                                                                 \
  X(DispatchCompute, DISPATCHCOMPUTE)                                                   \
  X(DispatchComputeIndirect, DISPATCHCOMPUTEINDIRECT)                                   \
  X(DrawArrays, DRAWARRAYS)                                                             \
  X(DrawBuffer, DRAWBUFFER)                                                             \
  X(Enable, ENABLE)                                                                     \
  X(Enablei, ENABLEI)                                                                   \
  X(FenceSync, FENCESYNC)                                                               \
  X(Finish, FINISH)                                                                     \
  X(GenTextures, GENTEXTURES)                                                           \
  X(GetError, GETERROR)                                                                 \
  X(GetFloati_v, GETFLOATI_V)                                                           \
  X(GetGraphicsResetStatus, GETGRAPHICSRESETSTATUS)                                     \
  X(GetInteger64i_v, GETINTEGER64I_V)                                                   \
  X(GetInteger64v, GETINTEGER64V)                                                       \
  X(GetIntegeri_v, GETINTEGERI_V)                                                       \
  X(GetIntegerv, GETINTEGERV)                                                           \
  X(GetNamedFramebufferAttachmentParameteriv, GETNAMEDFRAMEBUFFERATTACHMENTPARAMETERIV) \
  X(GetNamedFramebufferParameteriv, GETNAMEDFRAMEBUFFERPARAMETERIV)                     \
  X(GetNamedRenderbufferParameteriv, GETNAMEDRENDERBUFFERPARAMETERIV)                   \
  X(GetProgramBinary, GETPROGRAMBINARY)                                                 \
  X(GetProgramInfoLog, GETPROGRAMINFOLOG)                                               \
  X(GetProgramInterfaceiv, GETPROGRAMINTERFACEIV)                                       \
  X(GetProgramResourceName, GETPROGRAMRESOURCENAME)                                     \
  X(GetProgramResourceiv, GETPROGRAMRESOURCEIV)                                         \
  X(GetProgramiv, GETPROGRAMIV)                                                         \
  X(GetQueryObjectui64v, GETQUERYOBJECTUI64V)                                           \
  X(GetQueryiv, GETQUERYIV)                                                             \
  X(GetShaderInfoLog, GETSHADERINFOLOG)                                                 \
  X(GetShaderiv, GETSHADERIV)                                                           \
  X(GetString, GETSTRING)                                                               \
  X(GetStringi, GETSTRINGI)                                                             \
  X(GetTextureLevelParameteriv, GETTEXTURELEVELPARAMETERIV)                             \
  X(GetTextureParameteriv, GETTEXTUREPARAMETERIV)                                       \
  X(GetUniformLocation, GETUNIFORMLOCATION)                                             \
  X(IsEnabled, ISENABLED)                                                               \
  X(IsEnabledi, ISENABLEDI)                                                             \
  X(IsProgram, ISPROGRAM)                                                               \
  X(LinkProgram, LINKPROGRAM)                                                           \
  X(MapNamedBufferRange, MAPNAMEDBUFFERRANGE)                                           \
  X(MemoryBarrier, MEMORYBARRIER)                                                       \
  X(NamedBufferStorage, NAMEDBUFFERSTORAGE)                                             \
  X(NamedBufferSubData, NAMEDBUFFERSUBDATA)                                             \
  X(NamedFramebufferDrawBuffer, NAMEDFRAMEBUFFERDRAWBUFFER)                             \
  X(NamedFramebufferTexture, NAMEDFRAMEBUFFERTEXTURE)                                   \
  X(NamedFramebufferTextureLayer, NAMEDFRAMEBUFFERTEXTURELAYER)                         \
  X(ObjectLabel, OBJECTLABEL)                                                           \
  X(PolygonMode, POLYGONMODE)                                                           \
  X(PopDebugGroup, POPDEBUGGROUP)                                                       \
  X(ProgramBinary, PROGRAMBINARY)                                                       \
  X(ProgramParameteri, PROGRAMPARAMETERI)                                               \
  X(ProgramUniform1ui, PROGRAMUNIFORM1UI)                                               \
  X(PushDebugGroup, PUSHDEBUGGROUP)                                                     \
  X(QueryCounter, QUERYCOUNTER)                                                         \
  X(SamplerParameteri, SAMPLERPARAMETERI)                                               \
  X(ShaderSource, SHADERSOURCE)                                                         \
  X(TextureStorage2D, TEXTURESTORAGE2D)                                                 \
  X(TextureView, TEXTUREVIEW)                                                           \
  X(UnmapNamedBuffer, UNMAPNAMEDBUFFER)                                                 \
  X(UseProgram, USEPROGRAM)                                                             \
  X(ViewportIndexedf, VIEWPORTINDEXEDF)

using GetProcAddress = void (*(*)(const char* name))();

struct Functions {
#define BINOSPLAT_GL_MEMBER(name, upper) PFNGL##upper##PROC name = nullptr;
  BINOSPLAT_GL_FUNCTIONS(BINOSPLAT_GL_MEMBER)
#undef BINOSPLAT_GL_MEMBER
  /// From GL_KHR_parallel_shader_compile; null without it.
  PFNGLMAXSHADERCOMPILERTHREADSKHRPROC MaxShaderCompilerThreadsKHR = nullptr;
  /// From GL_EXT_memory_object; null without it. GL/glcorearb.h lacks its type.
  using GetBytes = void(APIENTRY*)(GLenum name, GLuint index, GLubyte* bytes);
  GetBytes GetUnsignedBytei_vEXT = nullptr;
};

constexpr const char* no_context =
    "no OpenGL context is current on this thread: make binosplat's context current first";

/// Loads the current context's entry points. Throws Error(no_gl) if no context is current, if it is older
/// than 4.5 or OpenGL ES, or if an entry point is missing; Error(bad_input) if get_proc_address is null.
Functions load_functions(GetProcAddress get_proc_address);

bool has_extension(const Functions& gl, std::string_view name);

}  // namespace binosplat::gl

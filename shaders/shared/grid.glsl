// The index of a work group or an invocation in a dispatch, which may be split into rows along y (gl/dispatch.h). A
// work group has THREADS invocations along x.
#include "shared/limits.h"

uint group_index() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

uint thread_index() { return group_index() * THREADS + gl_LocalInvocationID.x; }

// The index of an invocation in a dispatch that may be split over y (gl/dispatch.h); groups of THREADS along x.

uint group_index() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

uint thread_index() { return group_index() * THREADS + gl_LocalInvocationID.x; }

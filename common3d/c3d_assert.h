/* C3D_ASSERT(condition): FF_ASSERT (protocol/ff_assert.h) in this folder's words. What a caller of
 * c3d.h may get wrong is counted or answered with no handle; asserted is what the code knows. */
#ifndef C3D_ASSERT_H
#define C3D_ASSERT_H

#include "../protocol/ff_assert.h"

#define C3D_ASSERT FF_ASSERT

#endif

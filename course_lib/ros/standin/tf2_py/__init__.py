from course_lib.ros.tf2 import ConnectivityException as ConnectivityException
from course_lib.ros.tf2 import ExtrapolationException as ExtrapolationException
from course_lib.ros.tf2 import InvalidArgumentException as InvalidArgumentException
from course_lib.ros.tf2 import LookupException as LookupException
from course_lib.ros.tf2 import TimeoutException as TimeoutException
from course_lib.ros.tf2 import TransformException as TransformException

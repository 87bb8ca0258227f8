# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._field import Field as Field
from ._field_type import FieldType as FieldType
from ._individual_type_description import IndividualTypeDescription as IndividualTypeDescription
from ._key_value import KeyValue as KeyValue
from ._type_description import TypeDescription as TypeDescription
from ._type_source import TypeSource as TypeSource

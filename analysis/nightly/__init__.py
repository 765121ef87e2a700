"""A study night by night, on this machine or a cluster: what moved, what got slower, what is new or gone."""

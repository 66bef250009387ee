"""What a run is watched for, and which particle is to blame."""
